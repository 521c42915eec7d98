// Other libraries' times beside a study's: the table of benchmark_inference, read and drawn.

#include "rows.hpp"
#include "table_file.hpp"

#include <doctest/doctest.h>

#include <string>
#include <study/page/pictures.hpp>
#include <study/times/peers.hpp>
#include <vector>

using namespace support;

namespace {

constexpr auto& parsed = read_table<read_peer_times>;
constexpr auto& refused = refused_table<read_peer_times>;

} // namespace

TEST_SUITE("the program tactnet") {
    TEST_CASE("read_peer_times: single frames of all columns that are another library's microseconds") {
        const auto times =
            parsed("network,batch,tactnet_us,onednn_us,onednn_spread,tactnet_8bit_us,torch_us\n"
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
        const auto times = parsed("network,batch,tactnet_8bit_us,onednn_8bit_us,onednn_8bit_spread,torch_us\n"
                                  "tactnet6/28x50,1,11.5,38.5,0.01,nan\n");
        REQUIRE(times.size() == 1);
        CHECK(times[0].peer == "onednn");
        CHECK(times[0].bits == 8);
        CHECK(times[0].microseconds == 38.5);
    }

    TEST_CASE("read_peer_times: the processor that a table was made on, where it says so") {
        const auto times = parsed("network,batch,onednn_us,ratio,processor\ntactnet6/28x50,1,38.5,2,A 1\n");
        REQUIRE(times.size() == 1);
        CHECK(times[0].processor == "A 1");
        CHECK(parsed("network,batch,onednn_us\ntactnet6/28x50,1,38.5\n").at(0).processor.empty());
    }

    TEST_CASE("read_peer_times: refuses what is no such table, with its place") {
        const std::string head = "network,batch,onednn_us\n";
        CHECK(refused("") ==
              "line 1: expected the head of a table of benchmark_inference, 'network,batch,…', found ''");
        CHECK(refused("network;batch\n").starts_with("line 1: expected the head"));
        CHECK(refused("network,batch,a\"b_us\n") ==
              "line 1: expected columns of letters, digits and _, found 'a\"b_us'");
        CHECK(refused(head + "tactnet6/28x50,1\n") ==
              "line 2: expected 3 columns as in the head, found 'tactnet6/28x50,1'");
        for (const char* network : {"tactnet6", "tactnet6/28", "/28x50", "tactnet6/0x50", "tactnet6/28x50x3"})
            CHECK_MESSAGE(refused(head + network + ",1,30\n")
                              .starts_with("line 2: expected a network and its size, such as tactnet6/28x50"),
                          network);
        for (const char* time : {"0", "-3", "inf", "1e99", "3us"})
            CHECK_MESSAGE(refused(head + "tactnet4/7x13,1,5\ntactnet6/28x50,1," + time + "\n")
                              .starts_with("line 3: expected microseconds above 0 of onednn, found '"),
                          time);
    }

    TEST_CASE(
        "study_pictures: a peer stands at its time and the highest accuracy of its network, or nowhere") {
        const std::vector<study_row> rows{studied("net", 0.8, 10), studied("net", 0.9, 10, "thorough"),
                                          studied("other", 0.99, 5)};
        const auto script = [&](const std::vector<peer_time>& peers) {
            return study_pictures(rows, peers).front().script;
        };
        const std::string none = script({});
        CHECK(none.find("other libraries") == std::string::npos);
        CHECK(script({{"onednn", "net", 28, 50, 30}, {"onednn", "lost", 7, 13, 30}}) == none);
        const std::string drawn = script({{"onednn", "net", 7, 13, 30.25}});
        CHECK(drawn.find("30.25 90 \"net 7x13 by onednn\\n30.2 µs a frame\"\n") != std::string::npos);
        CHECK(drawn.find("title 'the same by other libraries'") != std::string::npos);
        CHECK(script({{"onednn", "net", 7, 13, 30.25, 8}}) == none); // of which there is no row
    }
}
