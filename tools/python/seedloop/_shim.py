"""One run of a study whose simulator is a Python function, in the folder of the run; the standard library alone."""

import json
import os
import sys
from multiprocessing.connection import Client

#: Where the request goes, and the word that lets it in.
ADDRESS, KEY = "SEEDLOOP_CALLBACK_ADDRESS", "SEEDLOOP_CALLBACK_KEY"


def main() -> int:
    """Hand the request over, write what comes back."""
    with open("request.json", "rb") as file:
        request = file.read()
    with Client(os.environ[ADDRESS], authkey=os.environ[KEY].encode()) as connection:
        connection.send_bytes(request)
        reply = json.loads(connection.recv_bytes())
    if "error" in reply:
        print(reply["error"], file=sys.stderr)
        return 1
    with open("results.json", "w", encoding="utf-8") as file:
        json.dump(reply["observables"], file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
