// SPDX-License-Identifier: MIT
// The main of programs of tests; a program that has one of its own leaves this one in the library.
int run_cases(int argc, char** argv);

int main(int argc, char** argv) { return run_cases(argc, argv); }
