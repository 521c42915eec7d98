#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/transform.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/evaluate.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The interface of a network of any type for training: its arrays and a few calls. Code that uses it
/// compiles once for all networks. trainable_network implements it.
class trainable {
public:
    /// Memory for a batch, of the network that made it.
    class workspace {
    public:
        virtual ~workspace() = default;
    };
    /// Writes a transformed image of counts.
    using transformer = void (*)(const image_transform&, const std::uint8_t* from, float* to);

    virtual ~trainable() = default;
    [[nodiscard]] virtual std::unique_ptr<trainable> copy() const = 0;

    [[nodiscard]] virtual shape input_shape() const = 0;
    [[nodiscard]] virtual std::size_t outputs() const = 0;
    [[nodiscard]] virtual bool needs_counts() const = 0;
    [[nodiscard]] virtual transformer image_transformer() const = 0;
    /// The arrays, as in basic_network.
    [[nodiscard]] virtual std::vector<parameter> describe() const = 0;
    [[nodiscard]] virtual std::span<float> learnable_values() = 0;
    [[nodiscard]] virtual std::span<float> running_statistics() = 0;
    [[nodiscard]] virtual double& epsilon() = 0;
    [[nodiscard]] virtual double& momentum() = 0;

    [[nodiscard]] virtual std::unique_ptr<workspace> make_workspace() const = 0;
    virtual void prepare(thread_pool& threads, workspace& space) const = 0;
    virtual void forward(const sample_batch& in, sample_batch& out, thread_pool& threads, workspace& space,
                         std::uint64_t seed, std::uint32_t step) = 0;
    virtual void backward(const sample_batch& in, const sample_batch& out, const sample_batch& out_gradient,
                          std::span<float> gradients, thread_pool& threads, workspace& space,
                          std::uint64_t seed, std::uint32_t step) const = 0;

    /// With running statistics.
    virtual void logits(const sample_batch& in, sample_batch& out, thread_pool& threads,
                        workspace& space) const = 0;

    /// Copies the arrays of a network of the same type. Throws std::invalid_argument for arrays of other
    /// sizes.
    void copy_from(std::span<const float> values, std::span<const float> statistics) {
        if (values.size() != learnable_values().size() || statistics.size() != running_statistics().size())
            detail::throw_invalid_argument({"trainable: expected ", learnable_values().size(),
                                            " parameters and ", running_statistics().size(),
                                            " running statistics, found ", values.size(), " and ",
                                            statistics.size()});
        std::copy(values.begin(), values.end(), learnable_values().begin());
        std::copy(statistics.begin(), statistics.end(), running_statistics().begin());
    }
    /// The values of one array of `describe`.
    [[nodiscard]] std::span<float> values_of(const parameter& p) {
        return (learnable(p.role) ? learnable_values() : running_statistics()).subspan(p.offset, p.size);
    }
    void copy_from(trainable& other) { copy_from(other.learnable_values(), other.running_statistics()); }

protected:
    trainable() = default;
    trainable(const trainable&) = default;
    trainable& operator=(const trainable&) = default;
};

/// Evaluates a network of any type, as the overload for a known type does. Inputs are (value − mean) × scale,
/// with a mean for each value of a sample, of compressed counts if there is an input function.
[[nodiscard]] inline evaluation evaluate(const trainable& network, std::span<const float> mean, float scale,
                                         const labelled_samples& samples, std::span<const std::size_t> chosen,
                                         thread_pool& threads, const test_time_augmentation& how = {},
                                         const input_function& function = {}) {
    samples.check(network.input_shape(), network.outputs());
    const auto space = network.make_workspace();
    network.prepare(threads, *space);
    return detail::evaluate(
        network.input_shape(), mean, scale, network.outputs(), samples, chosen, how,
        [&](const sample_batch& in, sample_batch& out) { network.logits(in, out, threads, *space); },
        function);
}

/// Implements `trainable` for a type of network: the only part that compiles anew for each network.
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
    [[nodiscard]] bool needs_counts() const override { return Network::needs_counts; }
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

}} // namespace tactnet
