// Writes TactNet-4 for 14 × 25 tactels as two headers, in single precision and in 8 bits. Its weights are
// drawn: what a network takes of a microcontroller does not depend on what it has learnt. A third header
// holds what decisions come to on this machine.

#include "decisions.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/tactnet4.hpp>
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
    if (count != 4) {
        std::fprintf(stderr, "write_headers: expected three headers to write\n");
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
        const decisions::outcome found = std::make_unique<decisions::life>()->play();
        tactnet::write_file(arguments[3],
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
