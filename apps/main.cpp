#include "commands.h"

int main(int argc, char** argv) { return meniscus::apps::run(argc, argv); }
