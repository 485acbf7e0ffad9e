"""Files: written whole or not at all, archives unpacked safely, XML and TOML read without surprises."""
