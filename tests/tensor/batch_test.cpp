#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <type_traits>

using namespace tactnet;

namespace {
constexpr shape size{2, 3, 2};
using images = batch<float, size, 4>;
} // namespace

static_assert(images::view_type::lane_block_size == 48);
static_assert(std::is_convertible_v<images::view_type, images::const_view_type>);
static_assert(!std::is_constructible_v<images::view_type, images::const_view_type>);

TEST_CASE("batch: samples lie side by side in lane blocks") {
    images b(6);
    CHECK(b.samples() == 6);
    CHECK(b.view().lane_blocks() == 2);
    CHECK(b.view().samples_in(0) == 4);
    CHECK(b.view().samples_in(1) == 2);
    for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t e = 0; e < size.size(); ++e)
            b(s, e) = static_cast<float>(100 * s + e);
    const float* memory = b.view().data();
    CHECK(reinterpret_cast<std::uintptr_t>(memory) % vector_alignment == 0);
    for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t e = 0; e < size.size(); ++e)
            CHECK(memory[s / 4 * 48 + e * 4 + s % 4] == static_cast<float>(100 * s + e));
    CHECK(b.view().lane_block(1) == memory + 48);
    for (std::size_t e = 0; e < size.size(); ++e) // lanes past the last sample
        for (std::size_t lane = 2; lane < 4; ++lane)
            CHECK(b.view().lane_block(1)[e * 4 + lane] == 0);
}

TEST_CASE("batch: whole samples in and out") {
    images b(5);
    tensor<float, size> in, out;
    for (std::size_t e = 0; e < size.size(); ++e)
        in.data()[e] = static_cast<float>(e + 1);
    b.set(4, in);
    b.get(4, out);
    CHECK(std::equal(in.begin(), in.end(), out.begin()));
    b.get(3, out);
    CHECK(out(1, 2, 1) == 0);
}

TEST_CASE("batch: all zero after every resize, also when it shrinks and grows again") {
    images b(5);
    for (const std::size_t samples : {5u, 1u, 0u, 8u, 9u}) {
        b.resize(samples);
        CHECK(b.samples() == samples);
        CHECK(b.view().lane_blocks() == (samples + 3) / 4);
        bool zero = true;
        for (std::size_t i = 0; i < b.view().lane_blocks() * 48; ++i) {
            zero = zero && b.view().data()[i] == 0;
            b.view().data()[i] = 9;
        }
        CHECK(zero);
    }
}

TEST_CASE("batch: parts are whole lane blocks, the last one with the samples that are left") {
    images b(9);
    b(4, 7) = 3, b(8, 1) = 4;
    const auto middle = b.view().part(1, 2), rest = b.view().part(1, 3);
    CHECK(middle.samples() == 4);
    CHECK(middle(0, 7) == 3);
    CHECK(rest.samples() == 5);
    CHECK(rest.samples_in(1) == 1);
    CHECK(rest(4, 1) == 4);
    const images::view_type nothing(nullptr, 9);
    CHECK(nothing.part(1, 2).data() == nullptr);
    CHECK(nothing.part(2, 3).samples() == 1);
}
