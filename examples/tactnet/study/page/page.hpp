#pragma once

// The report of a study: one HTML file that needs no other, light or dark as the reader has it.

#include "study/rows.hpp"

#include <string>
#include <vector>

struct drawn_study_picture {
    std::string caption, svg;
};

/// `images` says what all was trained and tested on, a sentence.
std::string study_page(const std::vector<study_row>& rows, const std::vector<drawn_study_picture>& pictures,
                       const std::string& images);
