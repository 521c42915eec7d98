// A slice of the list: deployed as streams, in single precision and in 8 bits.

#include <tactnet/quantisation/stream_calibration.hpp>

#include <doctest/doctest.h>

#include <deployment/recordings.hpp>
#include <operators/list.hpp>
#include <support/layers/whole_reference_streams.hpp>
#include <support/same_bits.hpp>

using namespace tactnet;

TEST_CASE_TEMPLATE_DEFINE("operators: in a stream, the bits of a batch, and in 8 bits those of the reference",
                          Example, streams_of_all) {
    using net = typename Example::between;
    const auto network = support::drawn_network<net>();
    const auto recordings =
        support::recordings(2 * kernels::lanes<float> + 1, Example::input.rows, Example::input.channels);
    const auto expected = support::in_batch(network, recordings, 3);
    const auto stream = deploy_stream(network);
    std::vector<float> all;
    for (std::size_t s = 0; s < recordings.size(); ++s) {
        std::vector<float> found = support::in_stream(stream, recordings[s]);
        REQUIRE(found.size() == Example::input.rows * stream.outputs);
        found.erase(found.begin(), found.end() - static_cast<std::ptrdiff_t>(expected[s].size()));
        CHECK(support::same_bits(found, expected[s])); // the last frame's where the batch has no others
        all.insert(all.end(), recordings[s].begin(), recordings[s].end());
    }
    // Any order of numbers is as good as another for calibration.
    const auto bytes = deploy_stream<eight_bit>(network, all);
    for (const std::vector<float>& recording : recordings) {
        std::vector<float> found(Example::input.rows * bytes.outputs);
        typename std::remove_cvref_t<decltype(bytes)>::state memory;
        CHECK(bytes.run(recording, memory, found) == Example::input.rows);
        CHECK(support::same_bits(found, support::reference_stream_outputs<net>(bytes.folded(), recording)));
    }
}
TEST_CASE_TEMPLATE_APPLY(
    streams_of_all, support::examples_of_slice<support::streamed_example, TACTNET_SLICE, TACTNET_SLICES>);
