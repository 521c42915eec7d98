#include <tactnet/operators.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <support/layers/conformance.hpp>
#include <support/same_bits.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using support::same_bits;

// Beyond what holds of every layer, a list gives the same bits as its layers called one by
// one, each with buffers of its own: what it keeps, overwrites and shares must not show.

namespace {

template <class T>
using array = aligned_vector<T>;

/// Calls layers one after the other.
template <class T>
class chain {
public:
    template <class... Specs, shape Input>
    static chain of(sequence<Specs...>, std::integral_constant<shape, Input>) {
        chain c;
        c.template append<Input, Specs...>();
        return c;
    }

    array<T> forward(execution_context p, const T* values, T* running, const array<T>& in,
                     std::size_t count) {
        kept_ = {in};
        for (std::size_t i = 0; i < layers_.size(); ++i) {
            p.place = static_cast<std::uint32_t>(i) + 1;
            layers_[i]->resize(count);
            layers_[i]->prepare(p, values, running);
            array<T> out(in.size() / layers_[0]->input.size() * layers_[i]->output.size());
            layers_[i]->forward(p, values, running, count, kept_.back().data(), out.data());
            kept_.push_back(out);
            values += layers_[i]->parameters, running += layers_[i]->statistics;
        }
        return kept_.back();
    }
    array<T> backward(execution_context p, const T* values, const array<T>& out_gradient, T* gradients,
                      std::size_t count) {
        array<T> from = out_gradient;
        for (const auto& layer : layers_)
            values += layer->parameters, gradients += layer->parameters;
        for (std::size_t i = layers_.size(); i-- > 0;) {
            p.place = static_cast<std::uint32_t>(i) + 1;
            values -= layers_[i]->parameters, gradients -= layers_[i]->parameters;
            array<T> to(kept_[i].size());
            layers_[i]->backward(p, values, count, kept_[i].data(), kept_[i + 1].data(), from.data(),
                                 to.data(), gradients);
            from = to;
        }
        return from;
    }

private:
    template <shape Input, class Spec, class... Rest>
    void append() {
        layers_.push_back(support::make_layer<Spec, T, Input>());
        append<Spec::template layer<T, Input>::output, Rest...>();
    }
    template <shape>
    void append() {}

    std::vector<std::unique_ptr<support::erased_layer<T>>> layers_;
    std::vector<array<T>> kept_;
};

template <class List, shape Input>
void check_chain() {
    using T = float;
    constexpr std::size_t count = kernels::lanes<T> + 2,
                          places = (count + kernels::lanes<T> - 1) / kernels::lanes<T> * kernels::lanes<T>;
    auto one = support::make_layer<List, T, Input>();
    auto many = chain<T>::of(List{}, std::integral_constant<shape, Input>{});
    random_stream random(3, random_purposes::order);
    const auto filled = [&](std::size_t size) {
        array<T> a(size);
        for (T& value : a)
            value = static_cast<T>(random.uniform(-1, 1));
        return a;
    };
    // Empty lanes stay empty.
    const auto samples = [&](std::size_t size) {
        array<T> a = filled(size * places);
        for (std::size_t s = count; s < places; ++s)
            for (std::size_t e = 0; e < size; ++e)
                a[(s / kernels::lanes<T> * size + e) * kernels::lanes<T> + s % kernels::lanes<T>] = 0;
        return a;
    };
    array<T> values = filled(one->parameters), running(one->statistics, T{1}), running_many = running;
    const array<T> in = samples(Input.size()), out_gradient = samples(one->output.size());
    thread_pool threads;
    const execution_context p{.threads = threads, .seed = 5, .step = 9};
    for (int step = 0; step < 2; ++step) { // the second in memory that was used
        array<T> out(one->output.size() * places), in_gradient(in.size()), gradients(values.size()),
            gradients_many = gradients;
        one->resize(count);
        one->prepare(p, values.data(), running.data());
        one->forward(p, values.data(), running.data(), count, in.data(), out.data());
        one->backward(p, values.data(), count, in.data(), out.data(), out_gradient.data(), in_gradient.data(),
                      gradients.data());
        CHECK(same_bits(out, many.forward(p, values.data(), running_many.data(), in, count)));
        CHECK(same_bits(running, running_many));
        CHECK(same_bits(in_gradient,
                        many.backward(p, values.data(), out_gradient, gradients_many.data(), count)));
        CHECK(same_bits(gradients, gradients_many));
    }
}

using small = sequence<conv2d<4, 3>, batch_norm, relu, max_pool<2>>;

} // namespace

TEST_CASE("sequence: the same bits as its layers one by one") {
    SUBCASE("a stage") {
        check_chain<small, shape{5, 4, 2}>();
    }
    SUBCASE("in place over a convolution, over batch norm, at the end") {
        check_chain<sequence<conv2d<3, 3>, relu, batch_norm, relu, conv2d<2, 2>, relu>, shape{5, 4, 2}>();
    }
    SUBCASE("in place where the output is needed behind") {
        check_chain<sequence<relu, dropout<50>, max_pool<2>, relu, dropout<20>, relu>, shape{5, 4, 2}>();
    }
    SUBCASE("two in place in a row") {
        check_chain<sequence<conv2d<3, 3>, dropout<50>, relu, dense<5>, dropout<10>, softmax>,
                    shape{4, 3, 1}>();
    }
    SUBCASE("softmax inside") {
        check_chain<sequence<conv2d<3, 3>, softmax, conv2d<2, 3>>, shape{4, 3, 1}>();
    }
    SUBCASE("blocks") {
        check_chain<
            sequence<conv2d<3, 3>, residual<sequence<conv2d<3, 3>, relu>>, relu,
                     residual<sequence<conv2d<5, 3>, batch_norm>, sequence<conv2d<5, 1>>>, relu, dense<3>>,
            shape{4, 3, 1}>();
    }
}
