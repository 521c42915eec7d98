// Writes TactNet-4 for 14 × 25 tactels as two headers, in single precision and in 8 bits. Its weights are
// drawn: what a network takes of a microcontroller does not depend on what it has learnt. A third and a
// fourth header hold a stream in both formats, a fifth what decisions come to on this machine, a sixth
// TactNet-4 for 16 × 16 tactels in 8 bits, for the examples of frameworks.

#include "decisions.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/text/numbers.hpp>
#include <tactnet/training/initialise.hpp>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

int main(int count, char** arguments) {
    using network = tactnet::tactnet4<tactnet::shape{14, 25}, 22>;
    constexpr std::size_t pixels = network::input_shape.size(), images = 20;
    if (count != 7) {
        std::fprintf(stderr, "write_headers: expected six headers to write\n");
        return 2;
    }
    try {
        tactnet::model<network> model;
        tactnet::initialise(model.network, tactnet::he_normal{}, 0);
        for (std::size_t c = 0; c < network::outputs; ++c)
            model.classes.push_back("object " + std::to_string(c));
        model.normalise.scale = 1.0f / 64;
        for (float& mean : model.normalise.mean.view().elements())
            mean = 20.25f;
        // Most of a frame is untouched.
        std::vector<std::uint8_t> touches(images * pixels);
        for (std::size_t i = 0; i < touches.size(); ++i) {
            const std::size_t drawn = i * i * 7 % 241;
            touches[i] = static_cast<std::uint8_t>(drawn < 120 ? 0 : drawn);
        }
        const auto frame = std::span(std::as_const(touches)).first<pixels>();
        const tactnet::header_description says{.network = "TactNet-4",
                                               .namespace_name = "gripper",
                                               .classes = {},
                                               .when = tactnet::header_packing::when_compiling};
        tactnet::write_file(arguments[1], tactnet::deployed_header(tactnet::deploy(model), says, frame));
        tactnet::write_file(
            arguments[2],
            tactnet::deployed_header(
                tactnet::deploy<tactnet::eight_bit>(model, std::span(std::as_const(touches))), says, frame));
        tactnet::model<tactnet::tactnet4<tactnet::shape{16, 16}, 4>> matrix;
        tactnet::initialise(matrix.network, tactnet::he_normal{}, 0);
        matrix.classes = {"ball", "bar", "ring", "plane"};
        matrix.normalise.scale = model.normalise.scale;
        const std::span<const std::uint8_t> matrices = std::span(std::as_const(touches)).first<27 * 256>();
        const tactnet::header_description named{.network = "TactNet-4",
                                                .namespace_name = "gripper",
                                                .classes = matrix.classes,
                                                .when = says.when};
        tactnet::write_file(arguments[6],
                            tactnet::deployed_header(tactnet::deploy<tactnet::eight_bit>(matrix, matrices),
                                                     named, matrices.first<256>()));
        // Squeezes of 50 frames with 3 features, as simulated ones have.
        using sequences = tactnet::network<tactnet::shape{50, 1, 3}, tactnet::gru<16>, tactnet::last_frame,
                                           tactnet::dense<3>>;
        sequences squeezes;
        tactnet::initialise(squeezes, tactnet::he_normal{}, 0);
        std::vector<float> recording(2 * sequences::input_shape.size());
        for (std::size_t i = 0; i < recording.size(); ++i)
            recording[i] = static_cast<float>(i * i * 7 % 97) / 48 - 1;
        const tactnet::header_description stream{
            .network = "A GRU", .namespace_name = "gripper", .classes = {}, .when = says.when};
        tactnet::write_file(arguments[3],
                            tactnet::deployed_header(tactnet::deploy_stream(squeezes), stream, recording));
        tactnet::write_file(arguments[4], tactnet::deployed_header(
                                              tactnet::deploy_stream<tactnet::eight_bit>(squeezes, recording),
                                              stream, recording));
        const decisions::outcome found = std::make_unique<decisions::life>()->play();
        tactnet::write_file(arguments[5],
                            "inline constexpr decisions::outcome expected{" + std::to_string(found.checksum) +
                                "u, " + std::to_string(found.label) + ", " + std::to_string(found.members) +
                                ", " + tactnet::shortest_number(found.probability) + ", " +
                                tactnet::shortest_number(found.gain) + "};\n");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_headers: %s\n", error.what());
        return 1;
    }
    return 0;
}
