#include <tactnet/operators/training.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{28, 50, 8};
using bound = trained_layer<dropout<30>, float, size>;
using images = batch<float, size, kernels::lanes<float>>;

images ones(std::size_t count) {
    images result(count);
    for (std::size_t s = 0; s < count; ++s)
        for (std::size_t e = 0; e < size.size(); ++e)
            result(s, e) = 1;
    return result;
}
images dropped(const images& in, execution_context p) {
    images out(in.samples());
    no_memory none;
    bound::forward(p, nullptr, nullptr, none, in.view(), out.view());
    return out;
}
bool equal(const images& a, const images& b, std::size_t sample_a, std::size_t sample_b) {
    bool same = true;
    for (std::size_t e = 0; e < size.size(); ++e)
        same = same && a(sample_a, e) == b(sample_b, e);
    return same;
}

} // namespace

TEST_CASE("dropout: keeps the mean, and 70 of 100 elements") {
    thread_pool threads;
    const images in = ones(3), out = dropped(in, {.threads = threads});
    std::size_t kept = 0;
    for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t e = 0; e < size.size(); ++e) {
            kept += out(s, e) != 0;
            CHECK((out(s, e) == 0 || out(s, e) == static_cast<float>(100.0 / 70)));
        }
    const double n = 3.0 * size.size(), deviation = std::sqrt(n * 0.3 * 0.7);
    CHECK(std::abs(static_cast<double>(kept) - 0.7 * n) < 5 * deviation); // one in 1.7 million
}

TEST_CASE("dropout: a function of seed, step, depth and sample") {
    thread_pool threads;
    const images in = ones(3);
    const images out = dropped(in, {.threads = threads, .seed = 5, .step = 6, .place = 7});
    CHECK(equal(out, dropped(in, {.threads = threads, .seed = 5, .step = 6, .place = 7}), 1, 1));
    CHECK(equal(out, dropped(ones(1), {.threads = threads, .seed = 5, .step = 6, .place = 7}), 0, 0));
    CHECK(!equal(out, out, 0, 1));
    CHECK(!equal(out, dropped(in, {.threads = threads, .seed = 4, .step = 6, .place = 7}), 0, 0));
    CHECK(!equal(out, dropped(in, {.threads = threads, .seed = 5, .step = 5, .place = 7}), 0, 0));
    CHECK(!equal(out, dropped(in, {.threads = threads, .seed = 5, .step = 6, .place = 6}), 0, 0));
}

TEST_CASE("dropout: gradients pass through what was kept") {
    thread_pool threads;
    const execution_context p{.threads = threads, .seed = 1, .step = 2, .place = 3};
    const images in = ones(2), out = dropped(in, p);
    images in_gradient(2);
    no_memory none;
    bound::backward(p, nullptr, none, in.view(), out.view(), in.view(), in_gradient.view(), nullptr);
    CHECK(equal(out, in_gradient, 0, 0));
    CHECK(equal(out, in_gradient, 1, 1));
}

TEST_CASE("execution_context: inner layers have places of their own, however deep and however many") {
    thread_pool threads;
    const execution_context network{.threads = threads};
    CHECK(network.of_inner(0).of_inner(5).place == 64 + 6);
    CHECK(network.of_skip().place == 64);
    std::set<std::uint64_t> places{network.place};
    std::size_t count = 1;
    std::vector<execution_context> level{network};
    for (int depth = 0; depth < 12; ++depth) {
        std::vector<execution_context> next;
        for (const execution_context& outer : level)
            for (const std::size_t index : {0u, 1u, 62u, 63u, 64u, 200u}) {
                places.insert(outer.of_inner(index).place), ++count;
                if (next.size() < 40)
                    next.push_back(outer.of_inner(index));
            }
        for (const execution_context& outer : level)
            places.insert(outer.of_skip().place), ++count;
        level.swap(next);
    }
    CHECK(places.size() == count);
}
