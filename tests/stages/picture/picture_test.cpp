#include "stages/picture/picture.h"
#include <gtest/gtest.h>
