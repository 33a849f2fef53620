#include "converters/export/basic_mesh.h"
#include "converters/worker/serve.h"

// A worker that decodes Draco.
int main() { return mesocell::serve_request(mesocell::decode_draco); }
