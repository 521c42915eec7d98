// A slice of the list: beside PyTorch's modules, whose results pytorch/outputs.py has written in double
// precision. Its outputs and gradients and those of tactnet lie within the bound of the reference.

#include <tactnet/io/safetensors.hpp>
#include <tactnet/networks/batch_passes.hpp>

#include <doctest/doctest.h>

#include <cctype>
#include <cstdlib>
#include <operators/list.hpp>
#include <span>
#include <string>
#include <support/layers/reference_of.hpp>
#include <vector>

using namespace tactnet;

namespace {

/// The file of an example, as outputs.py names it.
template <class Example>
safetensors results_of_pytorch() {
    const char* const folder = std::getenv("TACTNET_PYTORCH_OUTPUTS");
    REQUIRE_MESSAGE(folder != nullptr, "set TACTNET_PYTORCH_OUTPUTS to the folder that outputs.py wrote");
    std::string name;
    for (const char letter : Example::pytorch)
        name += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
    for (const std::size_t size : {Example::input.rows, Example::input.columns, Example::input.channels})
        name += "_" + std::to_string(size);
    return safetensors::read(folder + ("/" + name + ".safetensors"));
}
support::samples samples_of(std::span<const float> values, std::size_t size) {
    support::samples all;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i % size == 0)
            all.emplace_back(size);
        all.back()[i % size].value = static_cast<double>(values[i]);
    }
    return all;
}
std::size_t outside(std::span<const float> found, const support::samples& expected) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        wrong += !support::within(static_cast<double>(found[i]),
                                  expected[i / expected[0].size()][i % expected[0].size()]);
    return wrong;
}
template <class Batch>
void fill(Batch& to, std::span<const float> values, std::size_t size) {
    for (std::size_t i = 0; i < values.size(); ++i)
        to(i / size, i % size) = values[i];
}
template <class Batch>
std::vector<float> values_of(const Batch& from, std::size_t size, std::size_t samples) {
    std::vector<float> all;
    for (std::size_t i = 0; i < size * samples; ++i)
        all.push_back(from(i / size, i % size));
    return all;
}

} // namespace

TEST_CASE_TEMPLATE_DEFINE("operators: PyTorch's outputs and gradients, within the derived bound", Example,
                          pytorch_of_all) {
    using net = typename Example::alone;
    const safetensors file = results_of_pytorch<Example>();
    const std::vector<float> in = file.values<float>("input"), out = file.values<float>("output"),
                             out_gradient = file.values<float>("output_gradient"),
                             in_gradient = file.values<float>("input_gradient");
    constexpr std::size_t size = net::input_shape.size(), outputs = net::outputs;
    const std::size_t count = in.size() / size;
    REQUIRE(out.size() == count * outputs);
    net layer;
    // The arrays of both in order.
    std::size_t number = 0;
    std::vector<float> gradient_of_pytorch;
    layer.for_each_parameter([&](const parameter& p, std::span<float> values) {
        const std::string name = std::to_string(number++);
        const std::vector<float> given = file.values<float>("parameter." + name),
                                 gradient = file.values<float>("gradient." + name);
        CAPTURE(p.name);
        REQUIRE(given.size() == values.size());
        std::copy(given.begin(), given.end(), values.begin());
        gradient_of_pytorch.insert(gradient_of_pytorch.end(), gradient.begin(), gradient.end());
    });

    const support::reference_pointer reference = support::reference_of<typename Example::spec>::on(
        {Example::input.channels, Example::input.rows, Example::input.columns});
    const std::vector<double> values(layer.learnable_values().begin(), layer.learnable_values().end());
    const support::reference_call call{.values = std::span(values).first(net::parameters),
                                       .running = {},
                                       .roundoff = support::unit_roundoff<float>};
    const support::samples inputs = samples_of(in, size), expected = reference->forward(call, inputs);

    typename net::input_batch x(count), dx(count);
    typename net::output_batch y(count), dy(count);
    fill(x, in, size);
    fill(dy, out_gradient, outputs);
    std::vector<float> own(layer.learnable_values().size());
    thread_pool threads;
    typename net::workspace space;
    space.resize(count);
    layer.prepare(threads, space);
    layer.forward(x.view(), y.view(), threads, space);
    layer.backward(x.view(), y.view(), dy.view(), dx.view(), own, threads, space);

    CHECK(outside(out, expected) == 0);
    if (net::ends_in_softmax) // which the passes of a network leave to the loss
        return;
    CHECK(outside(values_of(y, outputs, count), expected) == 0);
    if (!reference->has_backward())
        return;
    const support::reference_gradients gradients =
        reference->backward(call, inputs, samples_of(out_gradient, outputs));
    CHECK(outside(in_gradient, gradients.input) == 0);
    CHECK(outside(values_of(dx, size, count), gradients.input) == 0);
    if (net::parameters > 0) {
        CHECK(outside(gradient_of_pytorch, {gradients.values}) == 0);
        CHECK(outside(std::span(own).first(net::parameters), {gradients.values}) == 0);
    }
}
TEST_CASE_TEMPLATE_APPLY(pytorch_of_all,
                         support::examples_of_slice<support::pytorch_example, TACTNET_SLICE, TACTNET_SLICES>);
