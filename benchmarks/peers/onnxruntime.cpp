#include "../support/described_network.hpp"
#include "onnx_model.hpp"
#include "peer.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <onnxruntime_c_api.h>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace benchmark {

namespace {

/// ONNX Runtime on the processor, on one thread, with all that it does to a graph beforehand. By its C
/// interface, from and to memory that stays.
class onnxruntime final : public peer {
public:
    onnxruntime(const described_network& network, std::size_t batch)
        : frames_(batch * network.maps().front().size()),
          logits_(batch * network.maps()[network.operations().back().output].size()) {
        if (api_ == nullptr)
            throw std::runtime_error("onnxruntime: expected a library for version " +
                                     std::to_string(ORT_API_VERSION) + " of its interface, found " +
                                     OrtGetApiBase()->GetVersionString());
        const std::string model = onnx_model(network, batch);
        OrtSessionOptions* settings = nullptr;
        check(api_->CreateEnv(ORT_LOGGING_LEVEL_ERROR, "benchmark", &environment_));
        check(api_->CreateSessionOptions(&settings));
        const std::unique_ptr<OrtSessionOptions, void (*)(OrtSessionOptions*)> kept(
            settings, [](OrtSessionOptions* one) { api_->ReleaseSessionOptions(one); });
        check(api_->SetIntraOpNumThreads(settings, 1));
        check(api_->SetInterOpNumThreads(settings, 1));
        check(api_->SetSessionGraphOptimizationLevel(settings, ORT_ENABLE_ALL));
        check(api_->CreateSessionFromArray(environment_, model.data(), model.size(), settings, &session_));
        check(api_->CreateCpuMemoryInfo(OrtArenaAllocator, OrtMemTypeDefault, &memory_));
        const tactnet::shape in = network.maps().front();
        const std::array<std::int64_t, 4> of_frames{whole(batch), whole(in.channels), whole(in.rows),
                                                    whole(in.columns)};
        const std::array<std::int64_t, 2> of_logits{whole(batch), whole(logits_.size() / batch)};
        check(api_->CreateTensorWithDataAsOrtValue(memory_, frames_.data(), frames_.size() * sizeof(float),
                                                   of_frames.data(), of_frames.size(),
                                                   ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT, &input_));
        check(api_->CreateTensorWithDataAsOrtValue(memory_, logits_.data(), logits_.size() * sizeof(float),
                                                   of_logits.data(), of_logits.size(),
                                                   ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT, &output_));
    }
    onnxruntime(const onnxruntime&) = delete;
    onnxruntime& operator=(const onnxruntime&) = delete;
    ~onnxruntime() override {
        api_->ReleaseValue(output_);
        api_->ReleaseValue(input_);
        api_->ReleaseMemoryInfo(memory_);
        api_->ReleaseSession(session_);
        api_->ReleaseEnv(environment_);
    }

    void run(std::span<const float> frames, std::span<float> logits) override {
        if (frames.size() != frames_.size() || logits.size() != logits_.size())
            throw std::runtime_error("onnxruntime: expected " + std::to_string(logits_.size()) +
                                     " logits, found " + std::to_string(logits.size()));
        std::copy(frames.begin(), frames.end(), frames_.begin());
        const char *const in = "frames", *const out = "logits";
        check(api_->Run(session_, nullptr, &in, &input_, 1, &out, 1, &output_));
        std::copy(logits_.begin(), logits_.end(), logits.begin());
    }

private:
    static std::int64_t whole(std::size_t value) { return static_cast<std::int64_t>(value); }
    static void check(OrtStatus* status) {
        if (status == nullptr)
            return;
        const std::string problem = api_->GetErrorMessage(status);
        api_->ReleaseStatus(status);
        throw std::runtime_error("onnxruntime: " + problem);
    }

    static const OrtApi* const api_; ///< null where the library is older than the header
    std::vector<float> frames_, logits_;
    OrtEnv* environment_ = nullptr;
    OrtSession* session_ = nullptr;
    OrtMemoryInfo* memory_ = nullptr;
    OrtValue *input_ = nullptr, *output_ = nullptr;
};

const OrtApi* const onnxruntime::api_ = OrtGetApiBase()->GetApi(ORT_API_VERSION);

} // namespace

std::unique_ptr<peer> make_onnxruntime(const described_network& network, std::size_t batch) {
    return std::make_unique<onnxruntime>(network, batch);
}

} // namespace benchmark
