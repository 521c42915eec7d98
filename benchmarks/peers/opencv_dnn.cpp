#include "../support/described_network.hpp"
#include "peer.hpp"

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <stdexcept>
#include <string>

namespace benchmark {

namespace {

int whole(std::size_t value) {
    return static_cast<int>(value);
}

/// OpenCV's own engine for networks, on the processor.
class opencv_dnn final : public peer {
public:
    opencv_dnn(const described_network& network, std::size_t batch) : layers_(network.maps().size(), 0) {
        cv::setNumThreads(1);
        const tactnet::shape in = network.maps().front();
        frames_.create({whole(batch), whole(in.channels), whole(in.rows), whole(in.columns)}, CV_32F);
        for (const operation& o : network.operations())
            add(o);
        net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
        net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    }

    void run(std::span<const float> frames, std::span<float> logits) override {
        std::copy(frames.begin(), frames.end(), frames_.ptr<float>());
        net_.setInput(frames_);
        const cv::Mat out = net_.forward();
        if (out.total() != logits.size())
            throw std::runtime_error("opencv_dnn: expected " + std::to_string(logits.size()) +
                                     " logits, found " + std::to_string(out.total()));
        std::copy_n(out.ptr<float>(), logits.size(), logits.begin());
    }

private:
    void add(const operation& o) {
        cv::dnn::LayerParams p;
        switch (o.what) {
        case operation::kind::convolution: {
            over(p, o.window);
            p.set("num_output", whole(o.to.channels));
            p.set("bias_term", true);
            p.blobs = {blob(o.weights, {whole(o.to.channels), whole(o.from.channels),
                                        whole(o.window.kernel.rows), whole(o.window.kernel.columns)}),
                       blob(o.bias, {1, whole(o.to.channels)})};
            const int in = evenly_padded(p, layers_[o.input]);
            if (o.accumulates) { // to what the output map held
                const int before = layers_[o.output];
                const int sum = join("Eltwise", {layer("Convolution", p, {in}), before});
                layers_[o.output] = o.relu ? layer("ReLU", {}, {sum}) : sum;
            } else {
                const int convolved = layer("Convolution", p, {in});
                layers_[o.output] = o.relu ? layer("ReLU", {}, {convolved}) : convolved;
            }
            break;
        }
        case operation::kind::pool:
        case operation::kind::average:
            over(p, o.window);
            p.set("pool", o.what == operation::kind::pool ? "max" : "ave");
            p.set("ceil_mode", false);
            layers_[o.output] = layer("Pooling", p, {layers_[o.input]});
            break;
        case operation::kind::relu:
            layers_[o.output] = layer("ReLU", p, {layers_[o.input]});
            break;
        case operation::kind::concatenation: {
            std::vector<int> inputs;
            for (const std::size_t map : o.inputs)
                inputs.push_back(layers_[map]);
            layers_[o.output] = join("Concat", inputs);
            break;
        }
        case operation::kind::dense:
            p.set("num_output", whole(o.to.channels));
            p.set("bias_term", true);
            p.blobs = {blob(o.weights, {whole(o.to.channels), whole(o.from.size())}),
                       blob(o.bias, {1, whole(o.to.channels)})};
            layers_[o.output] = layer("InnerProduct", p, {layers_[o.input]});
            break;
        }
    }

    static void over(cv::dnn::LayerParams& p, const tactnet::sliding_window& w) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return whole(reach > size ? reach - size : 0);
        };
        p.set("kernel_h", whole(w.kernel.rows));
        p.set("kernel_w", whole(w.kernel.columns));
        p.set("stride_h", whole(w.stride.rows));
        p.set("stride_w", whole(w.stride.columns));
        p.set("pad_t", whole(w.top));
        p.set("pad_l", whole(w.left));
        p.set("pad_b", missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top));
        p.set("pad_r", missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                               w.input.columns + w.left));
    }
    /// Convolutions take no padding that differs from side to side: a layer in front makes it.
    int evenly_padded(cv::dnn::LayerParams& p, int input) {
        const std::array<const char*, 4> sides{"pad_t", "pad_b", "pad_l", "pad_r"};
        std::array<int, 8> around{}; // before and after, of frames, channels, rows and columns
        for (std::size_t side = 0; side < 4; ++side)
            around[4 + side] = p.get<int>(sides[side]);
        if (around[4] == around[5] && around[6] == around[7])
            return input;
        for (const char* const side : sides)
            p.set(side, 0);
        cv::dnn::LayerParams padding;
        padding.set("paddings", cv::dnn::DictValue::arrayInt(around.data(), whole(around.size())));
        return layer("Padding", padding, {input});
    }
    static cv::Mat blob(const std::vector<float>& values, const std::vector<int>& sizes) {
        cv::Mat copy(sizes, CV_32F);
        std::copy(values.begin(), values.end(), copy.ptr<float>());
        return copy;
    }
    int layer(const std::string& type, cv::dnn::LayerParams p, const std::vector<int>& inputs) {
        const int id = net_.addLayer(type + std::to_string(count_++), type, p);
        for (std::size_t i = 0; i < inputs.size(); ++i)
            net_.connect(inputs[i], 0, id, whole(i));
        return id;
    }
    int join(const std::string& type, const std::vector<int>& inputs) { return layer(type, {}, inputs); }

    cv::dnn::Net net_;
    cv::Mat frames_;
    std::vector<int> layers_; ///< what makes each map; 0 is the frame
    std::size_t count_ = 0;
};

} // namespace

std::unique_ptr<peer> make_opencv_dnn(const described_network& network, std::size_t batch) {
    return std::make_unique<opencv_dnn>(network, batch);
}

} // namespace benchmark
