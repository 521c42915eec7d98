// Writes what compare.py compiles for a board: each network as a header of tactnet in both formats, as
// `tactnet export` does, and as tables for CMSIS-NN. tactnet's logits are checked here, those of CMSIS-NN on
// the board.
//
//   benchmark_boards FOLDER

#include "../support/checked_network.hpp"
#include "../support/whole_numbers.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace {

using namespace benchmark;

/// The tables that cmsis_nn.cpp includes.
class tables {
public:
    /// In single precision, or in 8 bits with these ranges. `largest_logit` is what the last byte stands for.
    /// `packed`: weights of four filters lie side by side, where a layer takes them so.
    tables(const described_network& network, const ranges* seen, float largest_logit, bool packed)
        : packs_(packed) {
        const std::vector<float> scales = seen != nullptr ? scales_of(network, *seen, largest_logit)
                                                          : std::vector<float>(network.maps().size(), 1);
        for (const operation& o : network.operations())
            add(o, seen != nullptr, scales[o.input], scales[o.output]);
        logit_scale_ = scales.back();
        text_ += "constexpr layer layers[] = {\n" + layers_ + "};\n";
    }
    [[nodiscard]] std::string text(std::span<const std::uint8_t> frame, std::span<const double> logits,
                                   bool bytes) {
        array("std::uint8_t", "counts", frame);
        array("float", "expected", std::vector<float>(logits.begin(), logits.end()));
        return text_ + "constexpr float logit_scale = " + tactnet::shortest_number(logit_scale_) +
               ", tolerance = " +
               tactnet::shortest_number(static_cast<float>(bytes ? byte_tolerance : float_tolerance)) + ";\n";
    }

private:
    void add(const operation& o, bool bytes, float input_scale, float output_scale) {
        const std::string number = std::to_string(count_++);
        const bool pools = o.bias.empty();
        // Products of matrices, which convolutions of fewer taps are not.
        const bool packed = packs_ && !pools && o.weights.size() / o.bias.size() >= 16;
        if (!pools && bytes) {
            const whole_numbers whole = quantised(o, input_scale);
            std::vector<std::int32_t> multipliers, shifts;
            for (const float unit : whole.units) {
                int shift = 0;
                multipliers.push_back(static_cast<std::int32_t>(std::min(
                    std::lrint(std::ldexp(std::frexp(unit / output_scale, &shift), 31)), 0x7FFFFFFFl)));
                shifts.push_back(shift);
            }
            array("std::int8_t", "weights" + number, channels_last(o, whole.weights));
            array("std::int32_t", "bias" + number, whole.bias);
            array("std::int32_t", "multipliers" + number, multipliers);
            array("std::int32_t", "shifts" + number, shifts);
        } else if (!pools) {
            std::vector<float> weights = channels_last(o, o.weights);
            if (packed)
                weights = in_fours(weights, o.bias.size());
            array("float", "weights" + number, weights);
            array("float", "bias" + number, o.bias);
        }
        const tactnet::shape kernel =
            o.what == operation::kind::dense
                ? o.from
                : tactnet::shape{o.window.kernel.rows, o.window.kernel.columns, o.from.channels};
        layers_ += "    {" + size(o.from) + ", " + size(kernel) + ", " + size(o.to) + ", " +
                   size({o.window.stride.rows, o.window.stride.columns, o.window.top}) + ", " +
                   std::to_string(o.window.left) + ", " + (o.relu ? "true, " : "false, ") +
                   (packed ? "true" : "false");
        layers_ += pools ? ", nullptr, nullptr" : ", weights" + number + ", bias" + number;
        layers_ += pools || !bytes ? ", nullptr, nullptr" : ", multipliers" + number + ", shifts" + number;
        layers_ += "},\n";
    }
    static std::string size(tactnet::shape s) {
        return "{" + std::to_string(s.rows) + ", " + std::to_string(s.columns) + ", " +
               std::to_string(s.channels) + "}";
    }
    /// From [output][tap] to [four outputs][tap][output].
    static std::vector<float> in_fours(const std::vector<float>& weights, std::size_t outputs) {
        const std::size_t taps = weights.size() / outputs;
        std::vector<float> to((outputs + 3) / 4 * 4 * taps);
        for (std::size_t i = 0; i < weights.size(); ++i)
            to[(i / taps / 4 * taps + i % taps) * 4 + i / taps % 4] = weights[i];
        return to;
    }
    template <class Values>
    void array(const std::string& type, const std::string& name, const Values& values) {
        text_ += "constexpr " + type + " " + name + "[] = {";
        for (const auto value : values) {
            if constexpr (std::is_same_v<decltype(value), const float>)
                text_ += tactnet::shortest_number(value) + ",";
            else
                text_ += std::to_string(value) + ",";
        }
        text_ += "};\n";
    }

    std::string text_, layers_;
    std::size_t count_ = 0;
    float logit_scale_ = 1;
    bool packs_;
};

template <class Network>
void write(const std::string& start) {
    const auto given = std::make_unique<const task<Network, std::uint8_t>>(std::size_t{8}, -200.0, 255.0);
    const auto frame = std::span(given->frames).template first<Network::input_shape.size()>();
    const auto model = std::make_unique<tactnet::model<Network>>();
    model->network = given->network;
    for (std::size_t c = 0; c < Network::outputs; ++c)
        model->classes.push_back(std::to_string(c));
    const tactnet::header_description says{.network = start,
                                           .namespace_name = "gripper",
                                           .classes = {},
                                           .when = tactnet::header_packing::when_compiling};
    const auto write_header = [&](const auto& deployed, const std::string& name, double tolerance) {
        std::array<float, Network::outputs> logits;
        const std::vector<double> expected(given->expected.begin(),
                                           given->expected.begin() + Network::outputs);
        if (deployed.infer(frame, logits) != tactnet::frame_status::ok ||
            !(error_of(logits, expected) < tolerance))
            throw std::runtime_error(name + ": wrong logits");
        tactnet::write_file(start + name, tactnet::deployed_header(deployed, says, frame));
    };
    write_header(tactnet::deploy(*model), "_single_precision.hpp", float_tolerance);
    write_header(tactnet::deploy<tactnet::eight_bit>(*model, std::span(given->frames)), "_eight_bit.hpp",
                 byte_tolerance);
    const described_network network = described_network::of(given->network);
    const ranges seen(network, given->frames);
    double largest_logit = 0;
    for (const double logit : given->expected)
        largest_logit = std::max(largest_logit, std::abs(logit));
    const auto write_tables = [&](const std::string& name, const ranges* of_bytes, bool packed) {
        tactnet::write_file(start + name + "_tables.hpp",
                            tables(network, of_bytes, static_cast<float>(largest_logit), packed)
                                .text(frame, std::span(given->expected).template first<Network::outputs>(),
                                      of_bytes != nullptr));
    };
    write_tables("_eight_bit", &seen, false);
    write_tables("_single_precision", nullptr, false);
    write_tables("_single_precision_packed", nullptr, true);
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "benchmark_boards: expected a folder to write\n");
        return 2;
    }
    try {
        write<tactnet::tactnet4<tactnet::shape{14, 25}, 22>>(arguments[1] + std::string("/tactnet4"));
        write<tactnet::tactnet6<tactnet::shape{28, 50}, 22>>(arguments[1] + std::string("/tactnet6"));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "benchmark_boards: %s\n", error.what());
        return 1;
    }
    return 0;
}
