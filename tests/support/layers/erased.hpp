#pragma once

// A layer behind virtual functions, so that the checks of conformance.cpp are compiled once for each number
// type and not once for each layer.

#include <tactnet/operators/training.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace support {

template <class Layer>
using value_of = typename Layer::value_type;

/// The forward pass of a layer on its own.
template <class Layer>
void run_forward(const tactnet::execution_context& p, const value_of<Layer>* values, value_of<Layer>* running,
                 typename Layer::memory& memory, tactnet::input_view<value_of<Layer>, Layer::input> in,
                 tactnet::output_view<value_of<Layer>, Layer::output> out) {
    if constexpr (tactnet::part_layer<Layer>) {
        if constexpr (Layer::observes)
            tactnet::for_each_part<Layer::by_parts>(
                p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
                    Layer::observe_forward(part, memory, in.part(first, last));
                });
        Layer::begin_forward(p, running, memory, in.samples());
    }
    tactnet::for_each_part<Layer::by_parts>(
        p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
            Layer::forward(part, values, running, memory, in.part(first, last), out.part(first, last));
        });
}

/// The backward pass of a layer on its own.
template <class Layer>
void run_backward(const tactnet::execution_context& p, const value_of<Layer>* values,
                  typename Layer::memory& memory, tactnet::input_view<value_of<Layer>, Layer::input> in,
                  tactnet::input_view<value_of<Layer>, Layer::output> out,
                  tactnet::input_view<value_of<Layer>, Layer::output> out_gradient,
                  tactnet::output_view<value_of<Layer>, Layer::input> in_gradient,
                  value_of<Layer>* gradients) {
    if constexpr (tactnet::part_layer<Layer>) {
        if constexpr (Layer::observes)
            tactnet::for_each_part<Layer::by_parts>(
                p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
                    Layer::observe_backward(part, memory, in.part(first, last), out.part(first, last),
                                            out_gradient.part(first, last));
                });
        Layer::begin_backward(p, values, memory, in.samples());
    }
    tactnet::for_each_part<Layer::by_parts>(
        p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
            Layer::backward(part, values, memory, in.part(first, last), out.part(first, last),
                            out_gradient.part(first, last), in_gradient.part(first, last), gradients);
        });
    if constexpr (tactnet::part_layer<Layer>)
        Layer::end_backward(memory, gradients);
}

template <class T>
class erased_layer {
public:
    virtual ~erased_layer() = default;

    tactnet::shape input, output;
    std::size_t parameters = 0, statistics = 0, multiply_adds = 0, multiply_adds_on_pixels = 0;
    bool in_place = false, keeps_output = false;

    [[nodiscard]] virtual std::vector<tactnet::parameter> describe() const = 0;
    virtual void resize(std::size_t count) = 0;
    virtual void prepare(const tactnet::execution_context& p, const T* values, const T* running) = 0;
    virtual void infer(const tactnet::execution_context& p, const T* values, const T* running,
                       std::size_t count, const T* in, T* out) = 0;
    virtual void forward(const tactnet::execution_context& p, const T* values, T* running, std::size_t count,
                         const T* in, T* out) = 0;
    virtual void backward(const tactnet::execution_context& p, const T* values, std::size_t count,
                          const T* in, const T* out, const T* out_gradient, T* in_gradient, T* gradients) = 0;
};

template <class Spec, class T, tactnet::shape Input>
class erased_layer_of final : public erased_layer<T> {
    using bound = tactnet::trained_layer<Spec, T, Input>;
    static_assert(tactnet::batch_layer<bound> && (tactnet::part_layer<bound> || !bound::by_parts));
    using input_view = tactnet::input_view<T, Input>;
    using output_view = tactnet::output_view<T, bound::output>;

public:
    erased_layer_of() {
        this->input = bound::input;
        this->output = bound::output;
        this->parameters = bound::parameters;
        this->statistics = bound::statistics;
        this->multiply_adds = bound::multiply_adds;
        this->multiply_adds_on_pixels = bound::multiply_adds_on_pixels;
        this->in_place = bound::in_place;
        this->keeps_output = bound::keeps_output;
    }
    [[nodiscard]] std::vector<tactnet::parameter> describe() const override {
        std::vector<tactnet::parameter> list;
        bound::describe("layer", list);
        return list;
    }
    void resize(std::size_t count) override { memory_.resize(count); }
    void prepare(const tactnet::execution_context& p, const T* values, const T* running) override {
        bound::prepare(p, values, running, memory_);
    }
    void infer(const tactnet::execution_context& p, const T* values, const T* running, std::size_t count,
               const T* in, T* out) override {
        bound::infer(p, values, running, memory_, input_view{in, count}, output_view{out, count});
    }
    void forward(const tactnet::execution_context& p, const T* values, T* running, std::size_t count,
                 const T* in, T* out) override {
        run_forward<bound>(p, values, running, memory_, input_view{in, count}, output_view{out, count});
    }
    void backward(const tactnet::execution_context& p, const T* values, std::size_t count, const T* in,
                  const T* out, const T* out_gradient, T* in_gradient, T* gradients) override {
        using result_view = tactnet::input_view<T, bound::output>;
        run_backward<bound>(p, values, memory_, input_view{in, count}, result_view{out, count},
                            result_view{out_gradient, count},
                            tactnet::output_view<T, Input>{in_gradient, count}, gradients);
    }

private:
    typename bound::memory memory_;
};

/// Makes a layer with a memory of its own.
template <class T>
using layer_maker = std::unique_ptr<erased_layer<T>> (*)();
template <class Spec, class T, tactnet::shape Input>
std::unique_ptr<erased_layer<T>> make_layer() {
    return std::make_unique<erased_layer_of<Spec, T, Input>>();
}

} // namespace support
