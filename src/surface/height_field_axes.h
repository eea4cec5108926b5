/// The axes of a height field.
#pragma once

#include "base/field_axes.h"
