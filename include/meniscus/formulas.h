/// Pure functions of the field, written once for C++ and GLSL.
#pragma once

#include "meniscus/formulas/eigen.h"
#include "meniscus/formulas/fluids.h"
#include "meniscus/formulas/kernels.h"
#include "meniscus/formulas/optics.h"
#include "meniscus/formulas/rain.h"
