// Writes a network as a header. With a weight file, those weights; without, a network that has learnt
// nothing, which is enough to build the example. The program `tactnet` does the same for all its networks.

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/training.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>

int main(int count, char** arguments) {
    using network = tactnet::tactnet4<tactnet::shape{7, 13}, 22>;
    if (count != 2 && count != 3) {
        std::fprintf(stderr, "write_header: expected the header to write, then at most a weight file\n");
        return 2;
    }
    try {
        tactnet::model<network> model;
        if (count == 3) {
            model = tactnet::load_model<network>(arguments[2]);
        } else {
            tactnet::initialise(model.network, tactnet::he_normal{}, 0);
            for (std::size_t c = 0; c < network::outputs; ++c)
                model.classes.push_back("object " + std::to_string(c));
        }

        std::array<std::uint8_t, network::input_shape.size()> frame{};
        for (std::size_t i = 30; i < 50; ++i)
            frame[i] = 120;
        tactnet::write_file(
            arguments[1],
            tactnet::deployed_header(
                tactnet::deploy(model),
                {.network = "TactNet-4", .namespace_name = "gripper", .classes = model.classes}, frame));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_header: %s\n", error.what());
        return 2;
    }
    return 0;
}
