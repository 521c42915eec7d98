#include "samples.hpp"

#include <tactnet/svm/kernel_training.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace tactnet;

// Where a part of the cross-validation leaves one side alone, that side is the answer to what was held out,
// which is of the other one: each of two points is labelled as the other.
TEST_CASE("kernel_training: a part that leaves one side without samples answers with the other side") {
    const support::samples two{1, {-1, 1}, {5, 9}};
    thread_pool alone;
    const auto machine =
        train_kernel_machine(two.rows(), two.labels,
                             kernel_training_options<rbf_kernel>{.probability_folds = 2}, alone)
            .machine;
    const platt_sigmoid expected = fit_platt_sigmoid(std::vector<double>{-1, 1}, std::vector<double>{1, -1}),
                        of_nothing = fit_platt_sigmoid(std::vector<double>{0, 0}, std::vector<double>{1, -1});
    REQUIRE(machine.parameters().sigmoids.size() == 1);
    const platt_sigmoid found = machine.parameters().sigmoids[0];
    CHECK(found.slope == expected.slope);
    CHECK(found.offset == expected.offset);
    CHECK(found.slope != of_nothing.slope);
    CHECK(found.slope >
          0); // the larger the value, the less likely the first class: labelled the wrong way round
}
