#include "study/page/class_rates.hpp"

#include "methods/training_settings.hpp"
#include "reports/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace {

double share(std::size_t part, std::size_t all) {
    return all == 0 ? std::nan("") : static_cast<double>(part) / static_cast<double>(all);
}

} // namespace

double class_rate::worst() const {
    return std::fmin(sensitivity, precision); // of which a NaN is passed over
}

std::vector<class_rate> class_rates(const study_row& row) {
    const std::size_t count = row.classes.size();
    std::vector<class_rate> rates;
    for (std::size_t c = 0; c < count; ++c) {
        class_rate& rate = rates.emplace_back();
        rate.name = row.classes[c];
        std::size_t taken = 0;
        for (std::size_t other = 0; other < count; ++other) {
            const std::size_t n = row.confusion(c, other);
            rate.images += n;
            taken += row.confusion(other, c);
            if (other != c && n > rate.times) {
                rate.times = n;
                rate.taken_for = row.classes[other];
            }
        }
        rate.sensitivity = share(row.confusion(c, c), rate.images);
        rate.precision = share(row.confusion(c, c), taken);
    }
    std::ranges::stable_sort(rates, [](const class_rate& a, const class_rate& b) {
        const bool known = !std::isnan(a.worst()), other_known = !std::isnan(b.worst());
        return known && other_known ? a.worst() < b.worst() : known && !other_known;
    });
    return rates;
}

std::string class_rates_table(const study_row& row, tactnet::split_rule rule) {
    const std::vector<class_rate> rates = class_rates(row);
    double lowest = 100;
    for (const class_rate& rate : rates)
        lowest = std::fmin(lowest, 100 * rate.worst());
    const double begin = axis_below(lowest);
    std::string text =
        fmt::format("<h2>How well {} knows each class</h2>\n<div class=\"wide\"><table>\n<tr><th>class</th>"
                    "<th>images</th><th>sensitivity, %</th><th class=\"bar\">{} to 100</th>"
                    "<th>precision, %</th><th class=\"bar\">{} to 100</th><th>mostly taken for</th></tr>\n",
                    escaped(title_of(row)), begin, begin);
    const auto cells = [&](double rate) {
        return std::isnan(rate)
                   ? "<td></td><td></td>"
                   : fmt::format("<td>{:.1f}</td>", 100 * rate) + bar_cell(begin, 100 * rate, begin);
    };
    for (const class_rate& rate : rates)
        text += fmt::format("<tr><td>{}</td><td>{}</td>", escaped(rate.name), rate.images) +
                cells(rate.sensitivity) + cells(rate.precision) +
                (rate.times == 0 ? "<td></td>"
                                 : fmt::format("<td>{}, {} of {}</td>", escaped(rate.taken_for), rate.times,
                                               rate.images)) +
                "</tr>\n";
    return text +
           fmt::format("</table></div>\n<p>Sensitivity: of the images of a class, those that are recognised. "
                       "Precision: of what is taken for a class, what is of it. All {} splits together, the "
                       "worst class first.</p>\n",
                       name_of(rule));
}
