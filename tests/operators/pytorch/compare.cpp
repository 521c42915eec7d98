// Compares layers with PyTorch's, whose results outputs.py has written: compare FOLDER. Outputs and gradients
// of both lie within the bound of the reference in double precision.

#include <tactnet/io/parameters.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <support/layers/reference_of.hpp>
#include <vector>

using namespace tactnet;

namespace {

/// Wrong numbers, and how many there were.
struct tally {
    std::size_t wrong = 0, compared = 0;

    void add(double found, const support::bounded& expected) {
        ++compared;
        wrong += !support::within(found, expected);
    }
};

support::samples samples_of(std::span<const float> values, std::size_t size) {
    support::samples all;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i % size == 0)
            all.emplace_back(size);
        all.back()[i % size].value = static_cast<double>(values[i]);
    }
    return all;
}
template <class Batch>
void fill(Batch& to, std::span<const float> values, std::size_t size) {
    for (std::size_t i = 0; i < values.size(); ++i)
        to(i / size, i % size) = values[i];
}

/// One layer of the table. `positions`: a number that PyTorch rounds for each output in units of a pixel,
/// which moves an output by as much of the difference of two inputs. `of_pytorch`: how far PyTorch's outputs,
/// and no others, may lie from the bound, in units roundoff.
template <class Spec, shape Input>
bool agrees(const std::string& folder, const char* name, double positions = 0, double of_pytorch = 0) {
    using net = network<Input, Spec>;
    const safetensors file = safetensors::read(folder + "/" + name + ".safetensors");
    net layer;
    load_parameters(layer, file);
    const std::vector<float> in = file.values<float>("selftest.input"),
                             out = file.values<float>("selftest.output"),
                             out_gradient = file.values<float>("selftest.output_gradient"),
                             in_gradient = file.values<float>("selftest.input_gradient");
    constexpr std::size_t size = Input.size(), outputs = net::outputs;
    const std::size_t count = in.size() / size;
    if (out.size() != count * outputs) {
        std::printf("%-28s expected %zu outputs, found %zu\n", name, count * outputs, out.size());
        return false;
    }

    const support::reference_pointer reference =
        support::reference_of<Spec>::on({Input.channels, Input.rows, Input.columns});
    const std::vector<double> values(layer.learnable_values().begin(), layer.learnable_values().end());
    const support::reference_call call{.values = std::span(values).first(net::parameters),
                                       .running = {},
                                       .roundoff = support::unit_roundoff<float>};
    const support::samples inputs = samples_of(in, size);
    support::samples expected = reference->forward(call, inputs);
    support::reference_gradients gradients =
        reference->backward(call, inputs, samples_of(out_gradient, outputs));
    // The largest difference of two inputs is 4; of the terms of a gradient, one per output, 2.
    for (support::sample& each : expected)
        for (support::bounded& b : each)
            b.error += 4 * positions * support::unit_roundoff<float>;
    for (support::sample& each : gradients.input)
        for (support::bounded& b : each)
            b.error += 2 * static_cast<double>(outputs) * positions * support::unit_roundoff<float>;

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

    tally theirs, ours;
    for (std::size_t i = 0; i < out.size(); ++i) {
        support::bounded right = expected[i / outputs][i % outputs];
        ours.add(static_cast<double>(y(i / outputs, i % outputs)), right);
        right.error += of_pytorch * support::unit_roundoff<float>;
        theirs.add(static_cast<double>(out[i]), right);
    }
    for (std::size_t i = 0; i < in.size(); ++i) {
        theirs.add(static_cast<double>(in_gradient[i]), gradients.input[i / size][i % size]);
        ours.add(static_cast<double>(dx(i / size, i % size)), gradients.input[i / size][i % size]);
    }
    for (const parameter& p : net::describe()) {
        const std::vector<float> of_file = file.values<float>("selftest.gradient." + p.name);
        for (std::size_t i = 0; i < p.size; ++i) {
            theirs.add(static_cast<double>(of_file.at(i)), gradients.values[p.offset + i]);
            ours.add(static_cast<double>(own[p.offset + i]), gradients.values[p.offset + i]);
        }
    }
    std::printf("%-28s %5zu numbers, outside of the bound: PyTorch's %zu, tactnet's %zu\n", name,
                theirs.compared, theirs.wrong, ours.wrong);
    return theirs.wrong == 0 && ours.wrong == 0;
}

constexpr interpolation bilinear = interpolation::bilinear;

} // namespace

int main(int count, char** arguments) {
    if (count != 2)
        return 2;
    const std::string folder = arguments[1];
    try {
        const bool good[] = {
            agrees<adaptive_average_pool<extent2d(3, 4)>, shape{7, 11, 2}>(folder, "adaptive_average_pool"),
            agrees<adaptive_max_pool<extent2d(3, 4)>, shape{7, 11, 2}>(folder, "adaptive_max_pool"),
            agrees<adaptive_max_pool<extent2d(9, 2)>, shape{5, 7, 3}>(folder, "adaptive_max_pool_larger"),
            agrees<conv2d<9, extent2d(3, 2), extent2d(2, 1), pad(1), in_groups(3)>, shape{7, 5, 6}>(folder,
                                                                                                    "conv2d"),
            agrees<dilated_conv2d<5, 3>, shape{7, 11, 3}>(folder, "dilated_conv2d"),
            agrees<dilated_conv2d<3, extent2d(3, 2), extent2d(2, 3), 1, padding::valid>, shape{7, 5, 4}>(
                folder, "dilated_conv2d_valid"),
            agrees<dilated_conv2d<7, 3, 2, 2, pad(2)>, shape{9, 5, 2}>(folder, "dilated_conv2d_strides"),
            agrees<dilated_conv2d<5, 3, 3, 1, padding::same, in_groups(5)>, shape{9, 7, 5}>(
                folder, "dilated_conv2d_depthwise"),
            // PyTorch subtracts 1 from the exponential, which has at most two units roundoff.
            agrees<elu<>, shape{7, 3, 5}>(folder, "elu", 0, 2), //
            agrees<elu<300>, shape{5, 7, 3}>(folder, "elu_small", 0, 2),
            agrees<parametric_relu, shape{7, 3, 5}>(folder, "parametric_relu"),
            agrees<transposed_conv2d<5, extent2d(3, 4), extent2d(2, 3), padding::valid>, shape{5, 7, 3}>(
                folder, "transposed_conv2d"),
            agrees<transposed_conv2d<7, 3, 2, pad(1, 0, 1, 0)>, shape{5, 3, 4}>(folder,
                                                                                "transposed_conv2d_cropped"),
            agrees<transposed_conv2d<3, 2, 3, padding::valid, false>, shape{3, 5, 2}>(
                folder, "transposed_conv2d_gaps"),
            agrees<transposed_conv2d<5, 1>, shape{1, 1, 3}>(folder, "transposed_conv2d_pixel"),
            agrees<upsample<3>, shape{5, 7, 2}>(folder, "upsample_nearest"),
            agrees<upsample_to<extent2d(13, 5)>, shape{5, 7, 3}>(folder, "upsample_nearest_to"),
            // Positions, up to the size of the map, are rounded three times in each direction.
            agrees<upsample<extent2d(2, 3), bilinear>, shape{5, 7, 2}>(folder, "upsample_bilinear", 3 * 12),
            agrees<upsample_to<extent2d(11, 17), bilinear>, shape{7, 13, 3}>(folder, "upsample_bilinear_to",
                                                                             3 * 20),
            agrees<upsample_to<extent2d(3, 5), bilinear>, shape{7, 13, 2}>(
                folder, "upsample_bilinear_smaller", 3 * 20),
        };
        return std::all_of(std::begin(good), std::end(good), [](bool each) { return each; }) ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "compare: %s\n", error.what());
        return 1;
    }
}
