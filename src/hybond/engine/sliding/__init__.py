"""Where machines slide after an event, and how motion along surfaces goes on."""
