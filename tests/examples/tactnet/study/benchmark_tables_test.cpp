// Tables that a study reads beside its own results: times of other libraries, and bytes of code.

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <string>
#include <string_view>
#include <study/benchmark_tables.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>

namespace {

/// What `Read` finds in a file of that text.
template <auto Read>
auto read_table(std::string_view text) {
    const support::temporary_folder folder;
    const auto path = folder / "table.csv";
    tactnet::write_file(path, text);
    return Read(path);
}

/// What its error says after the name of the file.
template <auto Read>
std::string refused_table(std::string_view text) {
    try {
        (void)read_table<Read>(text);
    } catch (const tactnet::file_error& error) {
        return error.place() + ": expected " + error.expected() + ", found " + error.found();
    }
    return "nothing";
}

constexpr auto& peers_in = read_table<read_peer_times>;
constexpr auto& refused_peers = refused_table<read_peer_times>;
constexpr auto& sizes_in = read_table<read_code_bytes>;
constexpr auto& refused_sizes = refused_table<read_code_bytes>;

} // namespace

TEST_SUITE("the program tactnet") {
    TEST_CASE("read_peer_times: single frames of all columns that are another library's microseconds") {
        const auto times =
            peers_in("network,batch,tactnet_us,onednn_us,onednn_spread,tactnet_8bit_us,torch_us\n"
                     "tactnet6/28x50,1,13,37.5,0.01,7,410\n"
                     "tactnet6/28x50,64,12,30,0.01,6,90\r\n"
                     "tactnet4/7x13,1,1.3,5.25,0.02,1,120");
        CHECK(times[0].bits == 32);
        REQUIRE(times.size() == 4);
        CHECK(times[0].peer == "onednn");
        CHECK(times[0].method == "tactnet6");
        CHECK(times[0].rows == 28);
        CHECK(times[0].columns == 50);
        CHECK(times[0].microseconds == 37.5);
        CHECK(times[1].peer == "torch");
        CHECK(times[3].method == "tactnet4");
        CHECK(times[3].microseconds == 120);
    }

    TEST_CASE("read_peer_times: peers in 8 bits are told apart, and those that did not run left out") {
        const auto times =
            peers_in("network,batch,tactnet_8bit_us,onednn_8bit_us,onednn_8bit_spread,torch_us\n"
                     "tactnet6/28x50,1,11.5,38.5,0.01,nan\n");
        REQUIRE(times.size() == 1);
        CHECK(times[0].peer == "onednn");
        CHECK(times[0].bits == 8);
        CHECK(times[0].microseconds == 38.5);
    }

    TEST_CASE("read_peer_times: the processor that a table was made on, where it says so") {
        const auto times = peers_in("network,batch,onednn_us,ratio,processor\ntactnet6/28x50,1,38.5,2,A 1\n");
        REQUIRE(times.size() == 1);
        CHECK(times[0].processor == "A 1");
        CHECK(peers_in("network,batch,onednn_us\ntactnet6/28x50,1,38.5\n").at(0).processor.empty());
    }

    TEST_CASE("read_peer_times: refuses what is no such table, with its place") {
        const std::string head = "network,batch,onednn_us\n";
        CHECK(refused_peers("") ==
              "line 1: expected the head of a table of benchmark_inference, 'network,batch,…', found ''");
        CHECK(refused_peers("network;batch\n").starts_with("line 1: expected the head"));
        CHECK(refused_peers("network,batch,a\"b_us\n") ==
              "line 1: expected columns of letters, digits and _, found 'a\"b_us'");
        CHECK(refused_peers(head + "tactnet6/28x50,1\n") ==
              "line 2: expected 3 columns as in the head, found 'tactnet6/28x50,1'");
        for (const char* network : {"tactnet6", "tactnet6/28", "/28x50", "tactnet6/0x50", "tactnet6/28x50x3"})
            CHECK_MESSAGE(refused_peers(head + network + ",1,30\n")
                              .starts_with("line 2: expected a network and its size, such as tactnet6/28x50"),
                          network);
        for (const char* time : {"0", "-3", "inf", "1e99", "3us"})
            CHECK_MESSAGE(refused_peers(head + "tactnet4/7x13,1,5\ntactnet6/28x50,1," + time + "\n")
                              .starts_with("line 3: expected microseconds above 0 of onednn, found '"),
                          time);
    }

    TEST_CASE("read_code_bytes: networks, sizes, bits and bytes") {
        const auto sizes =
            sizes_in("network,bits,bytes\ntactnet6/28x50,32,30303\r\ntactnet6-economical/7x13,8,9000\n");
        REQUIRE(sizes.size() == 2);
        CHECK(sizes[0].method == "tactnet6");
        CHECK(sizes[0].rows == 28);
        CHECK(sizes[0].columns == 50);
        CHECK(sizes[0].bits == 32);
        CHECK(sizes[0].bytes == 30303);
        CHECK(sizes[1].method == "tactnet6-economical");
        CHECK(sizes[1].bits == 8);
        CHECK(sizes[1].bytes == 9000);
    }

    TEST_CASE("read_code_bytes: refuses what is no such table, with its place") {
        const std::string head = "network,bits,bytes\n";
        CHECK(refused_sizes("network,bytes\n")
                  .starts_with("line 1: expected the head of a table of the target"));
        CHECK(refused_sizes(head + "tactnet6,32,5\n") ==
              "line 2: expected a network and its size, such as tactnet6/28x50, found 'tactnet6'");
        CHECK(refused_sizes(head + "tactnet6/28x50,32\n").starts_with("line 2: expected 3 columns"));
        CHECK(refused_sizes(head + "tactnet6/28x50,16,5\n") ==
              "line 2: expected 8 or 32 bits of a weight, found '16'");
        for (const char* bytes : {"0", "-1", "1e3", ""})
            CHECK_MESSAGE(refused_sizes(head + "tactnet6/28x50,32," + bytes + "\n") != "nothing", bytes);
    }
}
