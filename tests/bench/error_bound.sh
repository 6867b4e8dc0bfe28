#!/usr/bin/env bash
# Prints how often the bound of a choice by error is exceeded, in the 100 runs of ErrorBound.IsKept on larger rasters.
# It takes many minutes. Usage: error_bound.sh [SIDE [SCENE_TESTS]]: posts along a side, 192 by default.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export OTL_BOUND_SIDE=${1:-192}
"${2:-build/bin/scene_tests}" --gtest_filter='*ErrorBound.IsKept*' | awk '
  / bound / { print }
  / exceeded / { print; split($0, words, " "); exceeded += words[3]; runs += words[5] }
  END { printf "exceeded %d of %d\n", exceeded, runs; exit !(runs == 100 && exceeded <= 5) }'
