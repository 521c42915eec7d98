// tactnet_stream: recognises the frames of a sensor one by one, as they arrive.
//
//     tactnet_stream WEIGHTS [own] <STREAM
//
// WEIGHTS is of a TactNet-6 for 28 x 50 counts, such as `tactnet train` writes. The stream comes from
// standard input: frames of 1400 bytes one after the other, or packets of the device in own_device.hpp. Each
// frame makes a line of number, label, probability and the microseconds that recognising it took, with tabs
// between them. Exit status: 0, or 2 (bad input, damage in the stream, no frame in it, or output that cannot
// be written).

#include "own_device.hpp"

#include <tactnet/io.hpp>
#include <tactnet/sensors.hpp>
#include <tactnet/tactnet.hpp>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <printable.hpp>
#include <span>
#include <stack.hpp>
#include <standard_output.hpp>
#include <unistd.h>

namespace {

using network = tactnet::tactnet6<tactnet::shape{own_device::rows, own_device::columns, 1}, 22>;
/// True if the stream was whole, its frames were recognised and their lines written.
template <tactnet::frame_decoder Decoder>
bool run(Decoder decoder, const tactnet::model<network>& model) {
    const auto deployed = tactnet::deploy(model);
    bool all_well = true;
    const auto take = [&](const tactnet::frame_view& frame) {
        const auto cells = frame.as<network::input_shape>();
        const auto start = std::chrono::steady_clock::now();
        const auto found = cells ? deployed.classify(*cells) : std::nullopt;
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
        if (!found) {
            std::fprintf(stderr, "tactnet_stream: frame %llu cannot be recognised\n",
                         static_cast<unsigned long long>(frame.number));
            all_well = false;
            return;
        }
        std::printf("%llu\t%s\t%.4f\t%.1f\n", static_cast<unsigned long long>(frame.number),
                    model.classes[found->index].c_str(), found->probability, time.count());
    };
    const auto note = [&](tactnet::decode_status status) {
        if (status != tactnet::decode_status::damaged)
            return;
        std::fprintf(stderr, "tactnet_stream: %s\n", decoder.error().message().c_str());
        all_well = false;
    };
    std::size_t total = 0;
    std::array<std::byte, 4096> bytes;
    ssize_t got = 0;
    // Returns with what there is, so that a frame is not kept waiting for the next.
    while ((got = ::read(STDIN_FILENO, bytes.data(), bytes.size())) > 0) {
        total += static_cast<std::size_t>(got);
        note(decoder.push(std::span(bytes).first(static_cast<std::size_t>(got)), take));
        finish_output();
    }
    if (got < 0) {
        std::fprintf(stderr, "tactnet_stream: cannot read the stream: %s\n", std::strerror(errno));
        return false;
    }
    note(decoder.finish(take));
    finish_output();
    // Bytes in front of the first packet are passed over, so that all of another device's stream would be.
    if (all_well && decoder.frames() == 0) {
        std::fprintf(stderr, "tactnet_stream: expected frames, found none in %zu bytes\n", total);
        return false;
    }
    return all_well;
}

} // namespace

int main(int count, char** arguments) {
    require_stack("tactnet_stream");
    ignore_output_signals();
    const bool own = count == 3 && std::strcmp(arguments[2], "own") == 0;
    const bool help =
        count == 2 && (std::strcmp(arguments[1], "--help") == 0 || std::strcmp(arguments[1], "-h") == 0);
    if (help || (count != 2 && !own)) {
        std::fputs("usage: tactnet_stream WEIGHTS [own] <STREAM\n", help ? stdout : stderr);
        return help ? 0 : 2;
    }
    try {
        const auto model = tactnet::load_model<network>(arguments[1]);
        const bool well =
            own ? run(own_device(), model)
                : run(tactnet::matrix_stream({.rows = own_device::rows, .columns = own_device::columns}),
                      model);
        return well ? 0 : 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tactnet_stream: %s\n", printable(error.what()).c_str());
        return 2;
    }
}
