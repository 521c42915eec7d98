#pragma once

// The tables of a study as Markdown, for a README.

#include "study/rows.hpp"

#include <string>
#include <vector>

/// Tables between comments that say where each begins and ends, `<!-- study front -->`, `<!-- study methods
/// -->`, and
/// `<!-- study against -->` where the paper has any of the methods, to be copied as they are. `images` says
/// what it was made of.
std::string study_markdown(const std::vector<study_row>& rows, const std::string& images);
