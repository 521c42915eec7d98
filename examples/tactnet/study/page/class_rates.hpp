#pragma once

// How well each class is recognised.

#include "study/rows.hpp"

#include <cstddef>
#include <string>
#include <vector>

struct class_rate {
    std::string name;
    std::size_t images = 0;  ///< that show it, over all splits
    double sensitivity = 0;  ///< the share of them that is recognised; NaN without any
    double precision = 0;    ///< the share of what is taken for it that is it; NaN if nothing is
    std::string taken_for{}; ///< most often, where it is not recognised; empty if it always is
    std::size_t times = 0;   ///< how often that was

    /// The lower of both, as far as they are known.
    double worst() const;
};

/// Of all classes, the worst first.
std::vector<class_rate> class_rates(const study_row& row);

/// Part of the page.
std::string class_rates_table(const study_row& row, tactnet::split_rule rule);
