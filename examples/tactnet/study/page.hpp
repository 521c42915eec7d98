#pragma once

// The report of a study: tables, which the terminal shows too, as Markdown for a README and on one HTML page
// that needs no other file.

#include "reports/report.hpp"
#include "study/rows.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

struct study_table {
    std::string name;    ///< in the comments of the Markdown file
    std::string title;   ///< a heading
    std::string caption; ///< what it shows, a sentence
    table_cells cells;   ///< the head alone if there is nothing to show
    std::string notes{}; ///< a line for each row that is missing, with the reason
};

/// All methods.
study_table methods_table(const std::vector<study_row>& rows);
/// What else is known of them: other accuracies, times and bytes.
study_table details_table(const std::vector<study_row>& rows);
study_table probabilities_table(const std::vector<study_row>& rows);
study_table decisions_table(const std::vector<study_row>& rows);
/// All tables that have something to show, the methods with which no other is both faster and more accurate
/// first.
std::vector<study_table> study_tables(const std::vector<study_row>& rows);

/// What a report is of.
struct report_subject {
    std::string images;  ///< what all was trained and tested on, a sentence
    std::string program; ///< what trained and timed: processor, compiler, version
};

/// Tables between comments that say where each begins and ends, `<!-- study front -->` and
/// `<!-- study front ends -->`, to be copied as they are.
std::string study_markdown(const std::vector<study_row>& rows, const report_subject& of);

/// With pictures as SVG, each after its caption; an empty one is left out.
std::string study_page(const std::vector<study_row>& rows,
                       const std::vector<std::pair<std::string, std::string>>& pictures,
                       const report_subject& of);
