#pragma once

// How the networks of a study learn, epoch by epoch: the paper's figure 6.

#include "study/page/pictures.hpp"

#include <vector>

/// Of the most accurate row of each network, six of them at most; without a name if there are none.
study_picture learning_curves_picture(const std::vector<study_row>& rows);
