// Writes the headers that the test of this folder is built with.

#include "eight_bit_networks.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>

#include <cstdio>
#include <exception>

int main(int count, char** arguments) {
    if (count != 3)
        return 2;
    try {
        tactnet::write_file(arguments[1], tactnet::deployed_header(deployed_in_8_bits<rooted_network>(),
                                                                   {.network = "Roots and probabilities",
                                                                    .namespace_name = "rooted",
                                                                    .classes = {"a", "b", "c", "d"}},
                                                                   frame_of<rooted_network>(0)));
        tactnet::write_file(arguments[2],
                            tactnet::deployed_header(deployed_in_8_bits<branched_network>(),
                                                     {.network = "Every kind of step",
                                                      .namespace_name = "branched",
                                                      .classes = {},
                                                      .when = tactnet::header_packing::at_start},
                                                     frame_of<branched_network>(0)));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_headers: %s\n", error.what());
        return 1;
    }
    return 0;
}
