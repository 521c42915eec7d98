#include "../support/described_network.hpp"
#include "peer.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <net.h>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace benchmark {

namespace {

/// ncnn on the processor, on one thread, in single precision: its text of layers and their weights, both in
/// memory. Frames one after the other.
class ncnn_network final : public peer {
public:
    ncnn_network(const described_network& network, std::size_t batch)
        : batch_(batch), in_(network.maps().front()), names_(network.maps().size()) {
        net_.opt.num_threads = 1;
        net_.opt.lightmode =
            std::none_of(network.operations().begin(), network.operations().end(),
                         [](const operation& o) { return o.accumulates; }); // one reader each
        net_.opt.blob_allocator = &maps_;
        net_.opt.workspace_allocator = &workspace_;
        net_.opt.use_fp16_packed = net_.opt.use_fp16_storage = net_.opt.use_fp16_arithmetic = false;
        net_.opt.use_bf16_storage = false;
        names_[0] = layer("Input", {}, "");
        for (const operation& o : network.operations())
            add(o);
        const std::string text =
            "7767517\n" + std::to_string(blobs_) + " " + std::to_string(blobs_) + "\n" + lines_;
        const unsigned char* bytes = reinterpret_cast<const unsigned char*>(weights_.data());
        if (net_.load_param_mem(text.c_str()) != 0 || net_.load_model(bytes) == 0)
            throw std::runtime_error("ncnn: expected layers that it knows, found\n" + text);
    }
    void run(std::span<const float> frames, std::span<float> logits) override {
        const std::size_t classes = logits.size() / batch_;
        for (std::size_t b = 0; b < batch_; ++b) {
            ncnn::Mat in(whole(in_.columns), whole(in_.rows), whole(in_.channels)), out;
            for (std::size_t c = 0; c < in_.channels; ++c)
                std::copy_n(frames.data() + (b * in_.channels + c) * in_.area(), in_.area(),
                            static_cast<float*>(in.channel(whole(c)).data));
            ncnn::Extractor extractor = net_.create_extractor();
            if (extractor.input(0, in) != 0 || extractor.extract(blobs_ - 1, out) != 0 ||
                out.w != whole(classes))
                throw std::runtime_error("ncnn: a frame was not recognised");
            std::copy_n(static_cast<const float*>(out.data), classes, logits.data() + b * classes);
        }
    }

private:
    static int whole(std::size_t value) { return static_cast<int>(value); }
    /// Returns the name of what the layer writes.
    std::string layer(const std::string& type, const std::vector<std::string>& inputs,
                      const std::string& settings) {
        const std::string name = "blob" + std::to_string(blobs_++);
        lines_ += type + " " + name + " " + std::to_string(inputs.size()) + " 1";
        for (const std::string& input : inputs)
            lines_ += " " + input;
        lines_ += " " + name + settings + "\n";
        return name;
    }
    static std::string set(int key, std::size_t value) {
        return " " + std::to_string(key) + "=" + std::to_string(value);
    }
    /// Kernel, stride and what is added left, right, at the top and at the bottom, by the layer's keys.
    static std::string over(const tactnet::sliding_window& w, const int (&keys)[8]) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return reach > size ? reach - size : 0;
        };
        return set(keys[0], w.kernel.columns) + set(keys[1], w.kernel.rows) + set(keys[2], w.stride.columns) +
               set(keys[3], w.stride.rows) + set(keys[4], w.left) + set(keys[6], w.top) +
               set(keys[5], missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns,
                                    w.input.columns + w.left)) +
               set(keys[7],
                   missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top));
    }
    std::string with_weights(const char* type, const operation& o, const std::string& settings) {
        weights_.push_back(0); // the weights are floats
        weights_.insert(weights_.end(), o.weights.begin(), o.weights.end());
        weights_.insert(weights_.end(), o.bias.begin(), o.bias.end());
        return layer(type, {names_[o.input]}, set(0, o.to.channels) + settings);
    }
    void add(const operation& o) {
        const auto pool = [&](std::size_t type) {
            return layer("Pooling", {names_[o.input]},
                         set(0, type) + set(5, 1) + over(o.window, {1, 11, 2, 12, 3, 14, 13, 15}));
        };
        std::string& out = names_[o.output];
        switch (o.what) {
        case operation::kind::convolution: {
            const std::string other = out;
            out = with_weights("Convolution", o,
                               set(5, 1) + set(6, o.weights.size()) + set(9, o.relu && !o.accumulates) +
                                   over(o.window, {1, 11, 3, 13, 4, 15, 14, 16}));
            if (o.accumulates) {
                out = layer("BinaryOp", {out, other}, set(0, 0));
                if (o.relu)
                    out = layer("ReLU", {out}, "");
            }
            break;
        }
        case operation::kind::pool:
            out = pool(0);
            break;
        case operation::kind::average:
            out = pool(1);
            break;
        case operation::kind::dense:
            out = with_weights("InnerProduct", o, set(1, 1) + set(2, o.weights.size()));
            break;
        default:
            throw std::invalid_argument("ncnn: expected convolutions, pools and dense layers");
        }
    }

    std::size_t batch_;
    tactnet::shape in_;
    std::vector<std::string> names_; ///< of what each map holds by now
    std::string lines_;
    std::vector<float> weights_; ///< ncnn refers to them
    int blobs_ = 0;
    ncnn::UnlockedPoolAllocator maps_, workspace_;
    ncnn::Net net_;
};

} // namespace

std::unique_ptr<peer> make_ncnn(const described_network& network, std::size_t batch) {
    return std::make_unique<ncnn_network>(network, batch);
}

} // namespace benchmark
