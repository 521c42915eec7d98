// RTNeural's GRU and LSTM frame by frame, with sizes known when compiling, in one of its backends. CMake
// writes a unit for each backend, which defines the namespace and the function; the backends cannot share a
// unit.

#include "peer.hpp"

#include <RTNeural/RTNeural.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace benchmark {

namespace {

template <bool Lstm, int Features, int Hidden>
class rtneural_layer final : public peer {
    using layer = std::conditional_t<Lstm, RTNEURAL_NAMESPACE::LSTMLayerT<float, Features, Hidden>,
                                     RTNEURAL_NAMESPACE::GRULayerT<float, Features, Hidden>>;

public:
    /// By PyTorch's arrays, one after the other, and RTNeural's functions for them.
    explicit rtneural_layer(std::span<const float> values) {
        nlohmann::json arrays;
        const auto take = [&](std::size_t columns) {
            std::vector<std::vector<float>> rows((Lstm ? 4 : 3) * Hidden);
            for (std::vector<float>& row : rows) {
                row.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(columns));
                values = values.subspan(columns);
            }
            return rows;
        };
        arrays["weight_ih_l0"] = take(Features);
        arrays["weight_hh_l0"] = take(Hidden);
        for (const char* const name : {"bias_ih_l0", "bias_hh_l0"})
            for (const std::vector<float>& row : take(1))
                arrays[name].push_back(row[0]);
        if constexpr (Lstm)
            RTNEURAL_NAMESPACE::torch_helpers::loadLSTM<float>(arrays, "", model_.template get<0>());
        else
            RTNEURAL_NAMESPACE::torch_helpers::loadGRU<float>(arrays, "", model_.template get<0>());
    }
    void run(std::span<const float> recording, std::span<float> outputs) override {
        model_.reset();
        for (std::size_t f = 0; f < recording.size() / Features; ++f) {
            std::copy_n(recording.data() + f * Features, Features, frame_.data());
            model_.forward(frame_.data());
            std::copy_n(model_.getOutputs(), Hidden, outputs.data() + f * Hidden);
        }
    }

private:
    alignas(64) std::array<float, (Features + 15) / 16 * 16> frame_{}; // read in whole vectors
    RTNEURAL_NAMESPACE::ModelT<float, Features, Hidden, layer> model_;
};

} // namespace

std::unique_ptr<peer> TACTNET_MAKE_RTNEURAL(const recurrent_layer& wanted) {
    std::unique_ptr<peer> made;
    const auto offer = [&]<int Features, int Hidden>(std::integer_sequence<int, Features, Hidden>) {
        if (wanted.features != Features || wanted.hidden != Hidden)
            return;
        if (wanted.lstm)
            made = std::make_unique<rtneural_layer<true, Features, Hidden>>(wanted.values);
        else
            made = std::make_unique<rtneural_layer<false, Features, Hidden>>(wanted.values);
    };
    offer(std::integer_sequence<int, 6, 16>{});
    offer(std::integer_sequence<int, 32, 32>{});
    offer(std::integer_sequence<int, 64, 128>{});
    return made;
}

} // namespace benchmark
