// tactnet_own_object: simulates touches of the object in fork.hpp and draws them in characters. Exit status:
// 0 if each leaves a mark, else 1.

#include "fork.hpp"

#include <tactnet/simulation.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>

int main() {
    using namespace tactnet::simulation;
    paper_scene scene;
    paper_scene::frames frames;
    for (std::uint32_t number = 0; number < 3; ++number) {
        const auto numbers = [&](std::uint32_t what) {
            return tactnet::random_stream(1, tactnet::random_purposes::touch, number, what);
        };
        drawing random(numbers(0), numbers(1), numbers(2)); // of its shape, its pose and the force
        const touch some = fork(random);
        simulate(scene, some, {.frame = number}, frames);
        std::printf("pressed with %.1f N, %zu tactels touched\n", frames.contact.force, frames.contact.cells);
        for (std::size_t row = 0; row < 28; ++row) {
            for (std::size_t column = 0; column < 50; ++column)
                std::putchar(" .:-=+*#%@"[static_cast<std::size_t>(frames.measured(row, column)) * 9 / 255]);
            std::putchar('\n');
        }
        if (!frames.contact.converged || frames.contact.cells < 20)
            return 1;
    }
    return 0;
}
