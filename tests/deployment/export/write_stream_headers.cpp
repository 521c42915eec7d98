// Writes the headers of streams that the other programs of this folder are built with.

#include "streams.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>

#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace {

template <class Network, class Format>
void write(const char* to, const char* name_space, std::vector<std::string> classes) {
    tactnet::write_file(to, tactnet::deployed_header(deployed_stream_of<Network>(Format{}),
                                                     {.network = "A network of sequences",
                                                      .namespace_name = name_space,
                                                      .classes = std::move(classes)},
                                                     recordings<Network>(1, 1)));
}

} // namespace

int main(int count, char** arguments) {
    if (count != 4)
        return 2;
    try {
        write<recorded_network, tactnet::single_precision>(arguments[1], "recorded", {"slip", "grip"});
        write<recorded_network, tactnet::eight_bit>(arguments[2], "recorded_in_bytes", {});
        write<tagging_network, tactnet::eight_bit>(arguments[3], "tagging", {"first"});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_stream_headers: %s\n", error.what());
        return 1;
    }
    return 0;
}
