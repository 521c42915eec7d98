// Writes the headers that the other programs of this folder are built with.

#include "networks.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <cstdio>
#include <exception>

int main(int count, char** arguments) {
    if (count != 4)
        return 2;
    try {
        tactnet::write_file(arguments[1],
                            tactnet::deployed_header(deployed_network<small_network>(),
                                                     {.network = "TactNet-4",
                                                      .namespace_name = "gripper::recognition",
                                                      .classes = {"left", "\"a\\b\"\n?\?/", "é"}},
                                                     frame_of<small_network>(0)));
        tactnet::write_file(arguments[2],
                            tactnet::deployed_header(deployed_network<mixed_network>(),
                                                     {.network = "A test's own network\n\\",
                                                      .namespace_name = "mixed",
                                                      .classes = {},
                                                      .when = tactnet::header_packing::at_start},
                                                     frame_of<mixed_network>(0)));
        tactnet::write_file(arguments[3], tactnet::deployed_header(deployed_network<large_network>(),
                                                                   {.network = "A network of photographs",
                                                                    .namespace_name = "large",
                                                                    .classes = {}},
                                                                   frame_of<large_network>(0)));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_headers: %s\n", error.what());
        return 1;
    }
    return 0;
}
