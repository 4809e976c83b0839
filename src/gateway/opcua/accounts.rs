//! Who may read: users with passwords, stored as Argon2id hashes in a file of the server. Nobody is let in without one.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use opcua::server::ServerEndpoint;
use opcua::server::address_space::AccessLevel;
use opcua::server::authenticator::{
    AuthManager, Password, UserToken, user_pass_security_policy_id, user_pass_security_policy_uri,
};
use opcua::types::{Error, Identifier, NodeId, StatusCode, UAString, UserTokenPolicy, UserTokenType};
use serde::{Deserialize, Serialize};
use tokio::sync::Semaphore;

use super::log::log_line;
use super::{certificates, production_plan};
use crate::store::password;
use crate::store::ron_file::{self, ChecksumPolicy, RonError};

/// Name of the file in the folder of the server.
const FILE: &str = "users.ron";
/// Longest name and password, bytes: one without end would be hashed for as long.
const LONGEST: usize = 200;
/// Passwords that are tried at the same time, each with 19 MiB.
const PARALLEL_TRIALS: usize = 2;
/// After a wrong password its place is taken for so long: guessing is slow.
const PENALTY: Duration = Duration::from_secs(1);

/// A user.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct UserAccount {
    /// Hash of the password.
    hash: String,
    /// May propose orders.
    #[serde(default)]
    orders: bool,
}

/// The users by their names.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Users(BTreeMap<String, UserAccount>);

impl Users {
    /// Reads the file of a folder; without one there are no users.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(folder: &Path) -> Result<Self, RonError> {
        let path = folder.join(FILE);
        if !path.exists() {
            return Ok(Self::default());
        }
        ron_file::read_newest(&path, ChecksumPolicy::Lenient)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), RonError> {
        ron_file::write(&folder.join(FILE), ChecksumPolicy::Lenient, self)
    }

    /// Adds a user or changes the password of one; `orders` says whether the user may propose orders, `None` as before.
    ///
    /// # Errors
    /// The name or the password is empty or too long, or no salt is to be had.
    pub fn set(&mut self, name: &str, secret: &str, orders: Option<bool>) -> Result<(), String> {
        if name.is_empty() || secret.is_empty() || name.len() > LONGEST || secret.len() > LONGEST {
            return Err(format!("a name and a password have 1 to {LONGEST} bytes"));
        }
        let hash = password::hash(secret).map_err(|error| error.to_string())?;
        let before = self.0.get(name).is_some_and(|account| account.orders);
        self.0.insert(name.to_owned(), UserAccount { hash, orders: orders.unwrap_or(before) });
        Ok(())
    }

    /// Removes a user; returns whether there was one.
    pub fn remove(&mut self, name: &str) -> bool {
        self.0.remove(name).is_some()
    }

    /// Their names, and whether they may propose orders.
    pub fn names(&self) -> impl Iterator<Item = (&str, bool)> {
        self.0.iter().map(|(name, account)| (name.as_str(), account.orders))
    }

    /// Whether a password is that of a user. It takes as long for a name that nobody has.
    #[must_use]
    pub fn verify(&self, name: &str, secret: &str) -> bool {
        // A hash of nothing: no password has it.
        const NOBODY: &str =
            "$argon2id$v=19$m=19456,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA";
        let hash = self.0.get(name).map_or(NOBODY, |account| account.hash.as_str());
        secret.len() <= LONGEST && password::verify(secret, hash) && self.0.contains_key(name)
    }
}

/// Who may come in.
pub struct Admitted {
    users: Users,
    /// The files of trusted certificates.
    trusted: BTreeSet<OsString>,
}

impl Admitted {
    /// Reads a folder; nobody where the file of users cannot be read.
    pub fn read(folder: &Path) -> Self {
        Self { users: Users::read(folder).unwrap_or_default(), trusted: certificates::trusted_files(folder) }
    }

    /// Whether somebody of these may not come in any more, or not with the same password and rights: who is connected stays
    /// so otherwise, since the library asks no more.
    pub fn is_revoked_by(&self, newer: &Self) -> bool {
        let is_other = |(name, account): (&String, &UserAccount)| newer.users.0.get(name) != Some(account);
        self.users.0.iter().any(is_other) || !self.trusted.is_subset(&newer.trusted)
    }
}

/// Time between two looks whether a user is still one.
const LOOK_INTERVAL: Duration = Duration::from_secs(2);
/// Begin of the name of a session's user.
const TOKEN: &str = "user:";

/// The user of a session.
#[must_use]
pub fn name_of(token: &UserToken) -> &str {
    token.0.strip_prefix(TOKEN).unwrap_or_default()
}

/// Lets users in, lets them read, and some of them propose orders.
pub struct Accounts {
    folder: PathBuf,
    trials: Semaphore,
    /// The users, and when they were looked at.
    known: Mutex<(Users, Instant)>,
}

impl Accounts {
    /// The users of a folder.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        let known = Mutex::new((read_or_none(&folder), Instant::now()));
        Self { folder, trials: Semaphore::new(PARALLEL_TRIALS), known }
    }

    /// The account of a session's user; none if it was taken away.
    fn account(&self, token: &UserToken) -> Option<UserAccount> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.1.elapsed() >= LOOK_INTERVAL {
            *known = (read_or_none(&self.folder), Instant::now());
        }
        known.0.0.get(name_of(token)).cloned()
    }
}

/// The users; none where the file cannot be read, which the log says.
fn read_or_none(folder: &Path) -> Users {
    Users::read(folder).unwrap_or_else(|error| {
        log_line(&error.to_string());
        Users::default()
    })
}

fn refused() -> Error {
    Error::new(StatusCode::BadUserAccessDenied, "name or password is wrong")
}

#[async_trait::async_trait]
impl AuthManager for Accounts {
    async fn authenticate_username_identity_token(
        &self,
        _: &ServerEndpoint,
        name: &str,
        secret: &Password,
    ) -> Result<UserToken, Error> {
        let _trial = self.trials.acquire().await.map_err(|_| refused())?;
        let (folder, told, secret) = (self.folder.clone(), name.to_owned(), secret.get().to_owned());
        let tried = tokio::task::spawn_blocking(move || read_or_none(&folder).verify(&told, &secret));
        if tried.await.unwrap_or(false) {
            return Ok(UserToken(format!("{TOKEN}{name}")));
        }
        tokio::time::sleep(PENALTY).await;
        Err(refused())
    }

    fn user_token_policies(&self, endpoint: &ServerEndpoint) -> Vec<UserTokenPolicy> {
        vec![UserTokenPolicy {
            policy_id: user_pass_security_policy_id(endpoint),
            token_type: UserTokenType::UserName,
            issued_token_type: UAString::null(),
            issuer_endpoint_url: UAString::null(),
            security_policy_uri: user_pass_security_policy_uri(endpoint),
        }]
    }

    fn effective_user_access_level(&self, token: &UserToken, level: AccessLevel, _: &NodeId) -> AccessLevel {
        if self.account(token).is_some() { level & AccessLevel::CURRENT_READ } else { AccessLevel::empty() }
    }

    /// The one method is that for orders.
    fn is_user_executable(&self, token: &UserToken, method: &NodeId) -> bool {
        let is_order =
            matches!(&method.identifier, Identifier::String(id) if id.as_ref().ends_with(production_plan::METHOD_PATH));
        is_order && self.account(token).is_some_and(|account| account.orders)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(users: &[(&str, bool)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let mut all = Users::default();
        users.iter().for_each(|(name, orders)| all.set(name, "secret", Some(*orders)).unwrap());
        all.write(folder.path()).unwrap();
        folder
    }

    #[test]
    fn who_is_taken_away_or_changed_is_noticed_and_who_is_added_is_not() {
        let folder = folder_with(&[("planner", true)]);
        let path = folder.path();
        std::fs::create_dir(path.join("trusted")).unwrap();
        std::fs::write(path.join("trusted/one.der"), "1").unwrap();
        let before = Admitted::read(path);
        let is_revoked = || before.is_revoked_by(&Admitted::read(path));
        let change = |change: &dyn Fn(&mut Users)| {
            let mut users = Users::read(path).unwrap();
            change(&mut users);
            users.write(path).unwrap();
        };
        assert!(!is_revoked());
        change(&|users| users.set("viewer", "other", None).unwrap());
        std::fs::write(path.join("trusted/two.der"), "2").unwrap();
        assert!(!is_revoked());
        std::fs::remove_file(path.join("trusted/one.der")).unwrap();
        assert!(is_revoked(), "a certificate");
        std::fs::write(path.join("trusted/one.der"), "1").unwrap();
        assert!(!is_revoked());
        let later = Admitted::read(path);
        change(&|users| assert!(users.remove("viewer")));
        assert!(later.is_revoked_by(&Admitted::read(path)), "who came after the first look");
        change(&|users| users.set("planner", "secret", Some(false)).unwrap());
        assert!(is_revoked(), "the right to propose orders");
        change(&|users| assert!(users.remove("planner")));
        assert!(is_revoked(), "a user");
    }

    #[test]
    fn a_damaged_file_brings_no_removed_user_back() {
        let folder = folder_with(&[("planner", true), ("viewer", false)]);
        let mut users = Users::read(folder.path()).unwrap();
        assert!(users.remove("planner"));
        users.write(folder.path()).unwrap();
        let file = folder.path().join(FILE);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, format!("{text}?")).unwrap();
        assert!(Users::read(folder.path()).is_err());
        assert!(Admitted::read(folder.path()).users.names().next().is_none());
    }
}
