#pragma once

#include "resize.hpp"
