#pragma once

// The report of a study as a page of Markdown: tables, which the terminal shows too, and pictures.

#include "reports/report.hpp"
#include "study/rows.hpp"

#include <string>
#include <vector>

struct study_table {
    std::string name;    ///< in the comments of the page
    std::string title;   ///< a heading
    std::string caption; ///< what it shows, a sentence
    table_cells cells;   ///< the head alone if there is nothing to show
};

/// All methods.
study_table methods_table(const std::vector<study_row>& rows);
/// What else is known of them: other accuracies, times and bytes.
study_table details_table(const std::vector<study_row>& rows);
study_table probabilities_table(const std::vector<study_row>& rows);
study_table decisions_table(const std::vector<study_row>& rows);

/// What a report is of.
struct report_subject {
    std::string images;  ///< what all was trained and tested on, a sentence
    std::string program; ///< what trained and timed: processor, compiler, version
};

/// A picture in the folder of the page.
struct page_picture {
    std::string file, caption;
};

/// Pictures, and all tables that have something to show, the methods with which no other is both faster and
/// more accurate first. Tables stand between comments that say where each begins and ends, `<!-- study front
/// -->` and `<!-- study front ends -->`, to be copied as they are.
std::string study_page(const std::vector<study_row>& rows, const std::vector<page_picture>& pictures,
                       const report_subject& of);
