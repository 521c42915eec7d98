#pragma once

// Networks whose numbers are drawn from the names of their arrays, run stage by stage and compared with what
// torchvision made of the same numbers (tests/golden/imagenet_networks.py).

#include <tactnet/io/safetensors.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <support/layers/tile_magnitudes.hpp>
#include <utility>
#include <vector>

namespace support {

/// FNV-1a.
inline std::uint32_t hash_of(std::string_view text) {
    std::uint32_t hash = 0x811C9DC5;
    for (const char letter : text)
        hash = (hash ^ static_cast<std::uint8_t>(letter)) * 0x01000193;
    return hash;
}

/// Whole multiples of 2^-23 in [-1, 1), the same for the same name.
inline void draw_by_name(std::string_view name, std::span<float> values) {
    tactnet::random_stream random(2012, tactnet::random_purposes::order, hash_of(name));
    for (float& value : values)
        value = static_cast<float>(random.bits() >> 8) * 0x1p-23f - 1.0f;
}
template <class Network>
void fill_by_name(Network& net) {
    net.for_each_parameter([](const tactnet::parameter& p, std::span<float> values) {
        using tactnet::parameter_role;
        draw_by_name(p.name, values);
        const float spread = static_cast<float>(std::sqrt(6.0 / static_cast<double>(p.fan_in)));
        for (float& value : values) {
            if (p.role == parameter_role::scale || p.role == parameter_role::running_variance)
                value = 1.0f + 0.5f * value;
            else
                value *= p.role == parameter_role::weight ? spread : 0.125f;
        }
    });
}

/// What the golden file knows of one network.
class golden_stages {
public:
    explicit golden_stages(std::string network, const std::string& file = "imagenet_networks")
        : file_(tactnet::safetensors::read(std::filesystem::path(TACTNET_SOURCE_DIR) / "tests" / "golden" /
                                           (file + ".safetensors"))),
          network_(std::move(network)) {}

    /// Compares a stage that the file knows: `value(element)` of `size`, at places evenly spread or as it
    /// says. Deviations may be that much larger.
    template <class Value>
    void compare(const std::string& stage, std::size_t size, const Value& value, double factor = 1) {
        const std::string name = network_ + "/" + stage;
        if (!file_.contains(name))
            return;
        ++compared;
        const std::vector<double> golden = file_.values<double>(name);
        const std::size_t count = golden.size() / 2;
        const std::vector<double> places =
            file_.contains(name + ".at") ? file_.values<double>(name + ".at") : std::vector<double>{};
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t place =
                places.empty() ? (2 * k + 1) * size / (2 * count) : static_cast<std::size_t>(places[k]);
            const double error = std::abs(static_cast<double>(value(place)) - golden[k]);
            CAPTURE(name);
            CAPTURE(k);
            CHECK(error <= factor * golden[count + k]);
            if (error > 0)
                worst = std::max(worst, error / (factor * golden[count + k]));
        }
    }
    /// Whether these are the names and extents of torchvision's network.
    template <class Network>
    [[nodiscard]] bool has_names_of() const {
        std::vector<std::string> lines;
        for (const tactnet::parameter& p : Network::describe()) {
            std::string extents;
            for (const std::size_t e : p.extents)
                extents += (extents.empty() ? "" : "x") + std::to_string(e);
            lines.push_back(p.name + ":" + extents + "\n");
        }
        std::sort(lines.begin(), lines.end());
        std::string all;
        for (const std::string& line : lines)
            all += line;
        return file_.values<double>(network_ + "/names")[0] == static_cast<double>(hash_of(all));
    }

    std::size_t compared = 0;
    double worst = 0; ///< error as a share of its deviation

private:
    tactnet::safetensors file_;
    std::string network_;
};

/// Runs the layers of a list one after the other, lists inside lists first to last, and shows each stage by
/// its name.
template <class T>
class stage_walk {
public:
    stage_walk(golden_stages& golden, tactnet::thread_pool& threads, const T* values, const T* statistics)
        : golden_(golden), context_{.threads = threads}, values_(values), statistics_(statistics) {}

    template <class Spec, class Layer>
    tactnet::aligned_vector<T> through(const std::string& name, tactnet::aligned_vector<T> x) {
        x = inner<tactnet::without_name<Spec>, Layer>(name, std::move(x));
        if (!Spec::name.empty()) // or it has the name of the list around it
            golden_.compare(
                name, Layer::output.size(), [&](std::size_t e) { return x[e * tactnet::kernels::lanes<T>]; },
                factor_);
        return x;
    }

    /// How much larger than in the file the deviations may be by now.
    [[nodiscard]] double factor() const { return factor_; }

private:
    template <class Spec, class Layer>
    struct walk;
    template <class... Specs, class Layer>
    struct walk<tactnet::sequence<Specs...>, Layer> {
        static tactnet::aligned_vector<T> run(stage_walk& self, const std::string& name,
                                              tactnet::aligned_vector<T> x) {
            return [&]<std::size_t... I>(std::index_sequence<I...>) {
                ((x = self.through<Specs, typename Layer::template at<I>>(
                      tactnet::joined_name(name, std::string(Specs::name)), std::move(x))),
                 ...);
                return std::move(x);
            }(std::index_sequence_for<Specs...>{});
        }
    };
    template <class Spec, class Layer>
    tactnet::aligned_vector<T> inner(const std::string& name, tactnet::aligned_vector<T> x) {
        if constexpr (requires { sizeof(walk<Spec, Layer>); }) {
            return walk<Spec, Layer>::run(*this, name, std::move(x));
        } else {
            using tactnet::kernels::lanes;
            if constexpr (requires { Layer::fan_in, Layer::window.kernel, Layer::filters; })
                expect_tiles<Layer>();
            using batches = tactnet::trained_layer<Spec, T, Layer::input>;
            typename batches::memory memory;
            memory.resize(1);
            tactnet::aligned_vector<T> out(Layer::output.size() * lanes<T>);
            batches::prepare(context_, values_, statistics_, memory);
            batches::infer(context_, values_, statistics_, memory,
                           tactnet::input_view<T, Layer::input>(x.data(), 1),
                           tactnet::output_view<T, Layer::output>(out.data(), 1));
            values_ += Layer::parameters;
            statistics_ += Layer::statistics;
            return out;
        }
    }

    /// The file counts the roundings of taps. Where a convolution is computed by tiles its errors are larger,
    /// and so may be those of all that follows.
    template <class Convolution>
    void expect_tiles() {
        tactnet::sliding_window window = Convolution::window;
        window.input.channels = Convolution::channels;
        const auto c = tactnet::kernels::batch_convolution::forward(window, Convolution::filters);
        const tactnet::extent2d tile = tactnet::kernels::best_tile(c);
        if (tile != tactnet::extent2d(0))
            factor_ = std::max(factor_, tile_deviation(Convolution::channels, window.kernel.rows,
                                                       {tile.rows, tile.columns}));
    }

    golden_stages& golden_;
    tactnet::execution_context context_;
    const T *values_, *statistics_;
    double factor_ = 1; // of the deviations in the file
};

/// Every stage that the golden file knows within its deviation, by the layers one by one; then the logits of
/// the whole network. Gives the network.
template <class Network>
Network compare_stages(golden_stages& golden, const std::string& last) {
    using tactnet::kernels::lanes;
    Network net;
    fill_by_name(net);
    std::vector<float> image(Network::input_shape.size());
    draw_by_name("input", image);
    typename Network::input_batch in(1);
    in.set(0, tactnet::tensor_view<const float, Network::input_shape>(image.data()));
    tactnet::thread_pool threads;
    tactnet::aligned_vector<float> x(image.size() * lanes<float>);
    for (std::size_t e = 0; e < image.size(); ++e)
        x[e * lanes<float>] = image[e];
    stage_walk<float> walk(golden, threads, net.learnable_values().data(), net.running_statistics().data());
    walk.template through<typename Network::specification, typename Network::layers>("", std::move(x));
    typename Network::output_batch out(1);
    typename Network::workspace space;
    net.prepare(threads, space);
    net.logits(in, out, threads, space);
    golden.compare(
        last, Network::outputs, [&](std::size_t e) { return out(0, e); }, walk.factor());
    return net;
}

/// Whether the arrays of a network are those of another, by the same names, which continues with the ones
/// named.
template <class Begin, class Whole>
[[nodiscard]] bool begins_as(const std::vector<std::string>& behind) {
    std::vector<std::string> names, expected;
    for (const tactnet::parameter& p : Begin::describe())
        names.push_back(p.name);
    for (const tactnet::parameter& p : Whole::describe())
        expected.push_back(p.name);
    names.insert(names.end(), behind.begin(), behind.end());
    return names == expected;
}

} // namespace support
