"""The same work on other people's software, set up as its authors mean it to be used."""
