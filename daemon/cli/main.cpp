// SPDX-License-Identifier: MIT
#include <cstdio>

int main() { std::puts("popcut " POPCUT_VERSION); }
