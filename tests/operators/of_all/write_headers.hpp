// A slice of the list: a program that writes the networks of exported.hpp as headers, all into one file.

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>

#include <cstdio>
#include <deployment/export/eight_bit_networks.hpp>
#include <exception>
#include <operators/list.hpp>
#include <string>
#include <tuple>

template <class... Examples>
std::string headers_of(const std::tuple<Examples...>&) {
    std::string text =
        "#include <cstddef>\n\ntemplate <std::size_t Number, bool InBytes>\nstruct exported;\n";
    std::size_t number = 100 * TACTNET_SLICE; // so that no two units have the same names
    const auto add = [&](const auto& network, const auto& frame, bool in_bytes) {
        const std::string name = (in_bytes ? "bytes_" : "single_") + std::to_string(number);
        text += tactnet::deployed_header(network, {.network = name, .namespace_name = name, .classes = {}},
                                         frame);
        text += "template <>\nstruct exported<" + std::to_string(number) + ", " +
                (in_bytes ? "true" : "false") + "> {\n";
        for (const char* const member : {"recogniser", "folded", "packed"})
            text += std::string("    static const auto& ") + member + "() { return " + name + "::" + member +
                    "; }\n";
        text += "    static bool passes() { return " + name + "::passes_selftest(); }\n};\n";
    };
    const auto add_both = [&]<class Example>(const Example&) {
        using net = typename Example::between;
        add(deployed_network<net>(), frame_of<net>(0), false);
        add(deployed_in_8_bits<net>(), frame_of<net>(0), true);
        ++number;
    };
    (add_both(Examples{}), ...);
    return text;
}

int main(int count, char** arguments) {
    if (count != 2)
        return 2;
    try {
        tactnet::write_file(
            arguments[1],
            headers_of(
                support::examples_of_slice<support::deployed_example, TACTNET_SLICE, TACTNET_SLICES>{}));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_headers: %s\n", error.what());
        return 1;
    }
    return 0;
}
