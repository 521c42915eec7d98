#include <tactnet/training/loop/progress.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <string>

using namespace tactnet;

namespace {

template <class Check>
std::string told(const Check& check) {
    try {
        check(epoch_report{.epoch = 4, .rate = 0.5});
    } catch (const training_diverged& error) {
        return error.what();
    }
    return {};
}

} // namespace

TEST_CASE("divergence: a loss or a parameter that is not finite, with epoch and rate") {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    CHECK(told([](const epoch_report& r) { detail::check_loss(1e300, r, "step 1"); }).empty());
    CHECK(told([](const epoch_report& r) { detail::check_loss(infinite, r, "step 1"); }) ==
          "training diverged in epoch 4, step 1: expected a finite loss, found inf; lower the learning rate "
          "(now 0.500000)");
    std::array values{1.0f, -3e38f};
    const auto check = [&](const epoch_report& r) { detail::check_parameters(values, r); };
    CHECK(told(check).empty());
    values[1] = -std::numeric_limits<float>::infinity();
    CHECK(told(check) == "training diverged in epoch 4, last step: expected finite parameters, found -inf; "
                         "lower the learning rate (now 0.500000)");
}

TEST_CASE("divergence: a second moment that is infinite, or no number") {
    std::array values{1.0f, 3e38f};
    const auto check = [&](const epoch_report& r) { detail::check_squares(values, r); };
    CHECK(told(check).empty());
    values[1] = std::numeric_limits<float>::infinity();
    CHECK(told(check) ==
          "training diverged in epoch 4, its steps: expected gradients whose squares are finite, found "
          "inf; lower the learning rate (now 0.500000)");
    values[1] = std::numeric_limits<float>::quiet_NaN();
    CHECK(told(check).starts_with("training diverged in epoch 4, its steps: "));
}
