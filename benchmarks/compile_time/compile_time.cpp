// What the library costs the compiler: seconds of processor time and memory for small files, from nothing at
// all to a deployed TactNet-6. The compiler and its options are those of this build; each file is compiled
// several times and the median printed.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

struct cost {
    double seconds, megabytes;
};

cost compile(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const std::string& a : command)
        arguments.push_back(const_cast<char*>(a.c_str()));
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
    int status = 0;
    rusage used{};
    if (child < 0 || wait4(child, &status, 0, &used) != child || !WIFEXITED(status) ||
        WEXITSTATUS(status) != 0) {
        std::fprintf(stderr, "the compiler failed\n");
        std::exit(EXIT_FAILURE);
    }
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    // The peak of the largest process: the compiler proper, not its driver.
    return {seconds(used.ru_utime) + seconds(used.ru_stime), static_cast<double>(used.ru_maxrss) / 1024};
}

struct unit {
    const char* name;
    std::string text;
};

std::string deployed(const std::string& network) {
    return "#include <tactnet/tactnet.hpp>\n"
           "using network = " +
           network +
           ";\n"
           "tactnet::frame_status infer(const tactnet::deployed<network>& d,\n"
           "                            tactnet::tensor_view<const float, network::input_shape> frame,\n"
           "                            std::span<float, network::outputs> logits) {\n"
           "    return d.infer(frame, logits);\n"
           "}\n"
           "tactnet::deployed<network> make(const network& n) { return tactnet::deploy(n); }\n";
}

/// A network of more than ten kinds of layers.
std::string ten_kinds() {
    return "tactnet::network<tactnet::shape{28, 50, 1}, tactnet::conv2d<16, 3, 2>, tactnet::batch_norm,\n"
           "    tactnet::hard_swish,\n"
           "    tactnet::conv2d<16, 3, 1, tactnet::padding::same, tactnet::in_groups(16)>, "
           "tactnet::batch_norm,\n"
           "    tactnet::relu, tactnet::squeeze_excitation<16, 4>, tactnet::conv2d<24, 1>,\n"
           "    tactnet::max_pool<2>, tactnet::dilated_conv2d<24, 3>, tactnet::elu<>,\n"
           "    tactnet::residual<tactnet::sequence<\n"
           "        tactnet::conv2d<24, 3, 1, tactnet::padding::same, tactnet::in_groups(24)>,\n"
           "        tactnet::layer_norm<tactnet::norm_over::channels>, tactnet::conv2d<48, 1>, "
           "tactnet::gelu,\n"
           "        tactnet::conv2d<24, 1>>>,\n"
           "    tactnet::global_average_pool, tactnet::dense<22>>";
}

/// A network from a weight file: deployed, or as a model for further training.
std::string loaded(const char* header, const char* result, const char* call) {
    return std::string("#include <tactnet/io/") + header + ">\n" +
           "#include <tactnet/tactnet.hpp>\n"
           "using network = tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>;\n"
           "tactnet::" +
           result + "<network> load(const char* path) { return tactnet::" + call + "<network>(path); }\n";
}

/// The example of README.md.
std::string readme_example() {
    return "#include <tactnet/io/deployed_file.hpp>\n"
           "#include <tactnet/tactnet.hpp>\n"
           "#include <array>\n"
           "#include <cstdint>\n"
           "#include <iostream>\n"
           "using net = tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>;\n"
           "int main() {\n"
           "    const auto network = tactnet::load_deployed<net>(\"output/tactnet6.safetensors\");\n"
           "    std::array<std::uint8_t, 28 * 50> frame{};\n"
           "    if (const auto found = network.classify(frame))\n"
           "        std::cout << found->name << ' ' << found->probability << '\\n';\n"
           "}\n";
}

/// In 8 bits: from folded numbers, as a weight file and a header have them, or calibrated, which runs the
/// network in single precision too.
std::string deployed_in_8_bits(const std::string& network, bool calibrated) {
    return "#include <tactnet/quantisation.hpp>\n"
           "#include <tactnet/tactnet.hpp>\n"
           "using network = " +
           network +
           ";\n"
           "using bytes = tactnet::deployed<network, tactnet::eight_bit>;\n"
           "tactnet::frame_status infer(const bytes& d,\n"
           "                            tactnet::tensor_view<const float, network::input_shape> frame,\n"
           "                            std::span<float, network::outputs> logits) {\n"
           "    return d.infer(frame, logits);\n"
           "}\n" +
           (calibrated
                ? "bytes make(const network& n, std::span<const float, network::input_shape.size()> mean,\n"
                  "           std::span<const std::uint8_t> images) {\n"
                  "    return tactnet::deploy<tactnet::eight_bit>(n, mean, 1.0f, images);\n"
                  "}\n"
                : "bytes make(std::span<const float, bytes::view_type::folded_elements> folded) {\n"
                  "    return bytes(folded);\n"
                  "}\n");
}

} // namespace

int main(int count, char** arguments) {
    constexpr std::size_t rounds = 5;
    if (count < 2) {
        std::fprintf(stderr, "usage: benchmark_compile_time COMPILER OPTION...\n");
        return 2;
    }
    const std::vector<unit> units{
        {"an empty file", "\n"},
        {"xsimd alone", "#if __has_include(<xsimd/xsimd.hpp>)\n#include <xsimd/xsimd.hpp>\n#endif\n"},
        {"the core included", "#include <tactnet/tactnet.hpp>\n"},
        {"files included", "#include <tactnet/io.hpp>\n"},
        {"README's example", readme_example()},
        {"load_deployed, TactNet-6", loaded("deployed_file.hpp", "deployed", "load_deployed")},
        {"load_model, TactNet-6", loaded("model_file.hpp", "model", "load_model")},
        {"TactNet-4 28x50 deployed", deployed("tactnet::tactnet4<tactnet::shape{28, 50, 1}, 22>")},
        {"TactNet-6 28x50 deployed", deployed("tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>")},
        {"the same in 8 bits", deployed_in_8_bits("tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>", false)},
        {"the same, calibrated",
         deployed_in_8_bits("tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>", true)},
        {"TactNet-6 10x18 deployed", deployed("tactnet::tactnet6<tactnet::shape{10, 18, 1}, 22>")},
        {"more than ten kinds of layers", deployed(ten_kinds())},
        {"TactResNet 28x50 deployed", deployed("tactnet::tactresnet<tactnet::shape{28, 50, 1}, 22>")},
    };
    const auto folder = std::filesystem::temp_directory_path() /
                        ("tactnet_compile_time_" + std::to_string(static_cast<long>(getpid())));
    std::filesystem::create_directories(folder);
    std::printf("%-28s %9s %9s %12s\n", "median of 5 compilations", "seconds", "MB", "object, kB");
    for (const unit& u : units) {
        const std::string source = (folder / "unit.cpp").string(), object = (folder / "unit.o").string();
        std::ofstream(source) << u.text;
        std::vector<std::string> command(arguments + 1, arguments + count);
        command.insert(command.end(), {"-c", source, "-o", object});
        std::vector<double> seconds, megabytes;
        for (std::size_t round = 0; round < rounds; ++round) {
            const cost c = compile(command);
            seconds.push_back(c.seconds), megabytes.push_back(c.megabytes);
        }
        std::sort(seconds.begin(), seconds.end());
        std::sort(megabytes.begin(), megabytes.end());
        std::printf("%-28s %9.2f %9.0f %12.1f\n", u.name, seconds[rounds / 2], megabytes[rounds / 2],
                    static_cast<double>(std::filesystem::file_size(object)) / 1024);
    }
    std::filesystem::remove_all(folder);
}
