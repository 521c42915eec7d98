#pragma once

#include <tactnet/image/transform.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A network behind the interface of `trainable`: the only part that compiles anew for each network.
template <class Network>
class trainable_network final : public trainable {
    static constexpr shape input = Network::input_shape;

public:
    trainable_network() = default;
    explicit trainable_network(Network network) : network_(std::move(network)) {}

    [[nodiscard]] const Network& network() const { return network_; }

    [[nodiscard]] std::unique_ptr<trainable> copy() const override {
        return std::make_unique<trainable_network>(*this);
    }
    [[nodiscard]] shape input_shape() const override { return input; }
    [[nodiscard]] std::size_t outputs() const override { return Network::outputs; }
    [[nodiscard]] bool takes_counts() const override { return Network::takes_counts; }
    [[nodiscard]] transformer image_transformer() const override {
        return [](const image_transform& t, const std::uint8_t* from, float* to) {
            transform_image<input>(t, std::span<const std::uint8_t, input.size()>(from, input.size()),
                                   tensor_view<float, input>(to));
        };
    }
    [[nodiscard]] std::vector<parameter> describe() const override { return Network::describe(); }
    [[nodiscard]] std::span<float> learnable_values() override { return network_.learnable_values(); }
    [[nodiscard]] std::span<float> running_statistics() override { return network_.running_statistics(); }
    [[nodiscard]] double& epsilon() override { return network_.epsilon; }
    [[nodiscard]] double& momentum() override { return network_.momentum; }

    [[nodiscard]] std::unique_ptr<workspace> make_workspace() const override {
        return std::make_unique<own_workspace>();
    }
    void prepare(thread_pool& threads, workspace& space) const override {
        network_.prepare(threads, memory(space));
    }
    void forward(const sample_batch& in, sample_batch& out, thread_pool& threads, workspace& space,
                 std::uint64_t seed, std::uint32_t step) override {
        network_.forward({in.data(), in.samples()}, {out.data(), out.samples()}, threads, memory(space), seed,
                         step);
    }
    void backward(const sample_batch& in, const sample_batch& out, const sample_batch& out_gradient,
                  std::span<float> gradients, thread_pool& threads, workspace& space, std::uint64_t seed,
                  std::uint32_t step) const override {
        network_.backward({in.data(), in.samples()}, {out.data(), out.samples()},
                          {out_gradient.data(), out_gradient.samples()}, {nullptr, in.samples()}, gradients,
                          threads, memory(space), seed, step);
    }

    void logits(const sample_batch& in, sample_batch& out, thread_pool& threads,
                workspace& space) const override {
        network_.logits({in.data(), in.samples()}, {out.data(), out.samples()}, threads, memory(space));
    }

private:
    struct own_workspace final : workspace {
        typename Network::workspace memory;
    };
    static typename Network::workspace& memory(workspace& space) {
        return static_cast<own_workspace&>(space).memory;
    }

    Network network_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
