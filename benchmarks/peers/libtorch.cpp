#include "../support/described_network.hpp"
#include "peer.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <torch/torch.h>
#include <vector>

namespace benchmark {

namespace {

std::int64_t whole(std::size_t value) {
    return static_cast<std::int64_t>(value);
}

/// PyTorch's functions, called one after the other.
class libtorch final : public peer {
public:
    libtorch(const described_network& network, std::size_t batch)
        : operations_(network.operations()), maps_(network.maps().size()) {
        torch::set_num_threads(1);
        const tactnet::shape in = network.maps().front();
        frames_ = torch::empty({whole(batch), whole(in.channels), whole(in.rows), whole(in.columns)});
        for (const operation& o : operations_) {
            constants held;
            if (!o.bias.empty()) {
                held.weight = tensor(o.weights);
                held.weight =
                    o.what == operation::kind::dense
                        ? held.weight.view({whole(o.to.channels), -1})
                        : held.weight.view({whole(o.to.channels), whole(o.from.channels),
                                            whole(o.window.kernel.rows), whole(o.window.kernel.columns)});
                held.bias = tensor(o.bias);
            }
            held.padding = paddings(o.window);
            constants_.push_back(std::move(held));
        }
    }

    void run(std::span<const float> frames, std::span<float> logits) override {
        const torch::InferenceMode only_forward;
        std::copy(frames.begin(), frames.end(), frames_.data_ptr<float>());
        maps_[0] = frames_;
        for (std::size_t i = 0; i < operations_.size(); ++i)
            apply(operations_[i], constants_[i]);
        const torch::Tensor out = maps_[operations_.back().output].contiguous();
        if (static_cast<std::size_t>(out.numel()) != logits.size())
            throw std::runtime_error("libtorch: expected " + std::to_string(logits.size()) +
                                     " logits, found " + std::to_string(out.numel()));
        std::copy_n(out.data_ptr<float>(), logits.size(), logits.begin());
    }

private:
    struct constants {
        torch::Tensor weight, bias;
        std::vector<std::int64_t> padding; ///< left, right, top, bottom
    };

    void apply(const operation& o, const constants& held) {
        const torch::Tensor in = maps_[o.input];
        const auto& w = o.window;
        const std::vector<std::int64_t> kernel{whole(w.kernel.rows), whole(w.kernel.columns)},
            stride{whole(w.stride.rows), whole(w.stride.columns)};
        switch (o.what) {
        case operation::kind::convolution: {
            torch::Tensor out =
                even(held.padding)
                    ? torch::conv2d(in, held.weight, held.bias, stride,
                                    std::vector<std::int64_t>{held.padding[2], held.padding[0]})
                    : torch::conv2d(torch::constant_pad_nd(in, held.padding), held.weight, held.bias, stride);
            if (o.accumulates)
                out.add_(maps_[o.output]);
            maps_[o.output] = o.relu ? out.relu_() : out;
            break;
        }
        case operation::kind::pool:
            // Windows side by side may reach beyond the end: that is ceil_mode. All else is padding.
            if (held.padding[0] == 0 && held.padding[2] == 0 && w.stride == w.kernel)
                maps_[o.output] =
                    torch::max_pool2d(in, kernel, stride, 0, 1, held.padding[1] + held.padding[3] > 0);
            else
                maps_[o.output] = torch::max_pool2d(
                    torch::constant_pad_nd(in, held.padding, -std::numeric_limits<float>::infinity()), kernel,
                    stride);
            break;
        case operation::kind::average:
            maps_[o.output] = torch::avg_pool2d(in, kernel, stride);
            break;
        case operation::kind::relu:
            maps_[o.output] = torch::relu(in);
            break;
        case operation::kind::concatenation: {
            std::vector<torch::Tensor> inputs;
            for (const std::size_t map : o.inputs)
                inputs.push_back(maps_[map]);
            maps_[o.output] = torch::cat(inputs, 1);
            break;
        }
        case operation::kind::dense:
            maps_[o.output] = torch::linear(in.flatten(1), held.weight, held.bias);
            break;
        }
    }

    static bool even(const std::vector<std::int64_t>& padding) {
        return padding[0] == padding[1] && padding[2] == padding[3];
    }
    static std::vector<std::int64_t> paddings(const tactnet::sliding_window& w) {
        const auto missing = [](std::size_t reach, std::size_t size) {
            return whole(reach > size ? reach - size : 0);
        };
        return {
            whole(w.left),
            missing((w.output_columns() - 1) * w.stride.columns + w.kernel.columns, w.input.columns + w.left),
            whole(w.top),
            missing((w.output_rows() - 1) * w.stride.rows + w.kernel.rows, w.input.rows + w.top)};
    }
    static torch::Tensor tensor(const std::vector<float>& values) {
        torch::Tensor copy = torch::empty({whole(values.size())});
        std::copy(values.begin(), values.end(), copy.data_ptr<float>());
        return copy;
    }

    std::vector<operation> operations_;
    std::vector<constants> constants_;
    std::vector<torch::Tensor> maps_;
    torch::Tensor frames_;
};

} // namespace

std::unique_ptr<peer> make_libtorch(const described_network& network, std::size_t batch) {
    return std::make_unique<libtorch>(network, batch);
}

} // namespace benchmark
